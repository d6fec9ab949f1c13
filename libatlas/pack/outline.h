// Packing charts by their outlines instead of their boxes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"
#include "libatlas/pack/pack.h"

namespace atlas {

// A flat chart: an unordered set of triangles in texels at scale 1. The coordinates may have any
// origin; they must be finite and below 1e9 in absolute value. The triangles may have either
// orientation. The data that the spans refer to must outlive the shape. A shape without triangles
// takes no space.
struct ChartShape {
  std::span<const Vec2d> corners = {};  // the vertices
  // Three indices into corners per triangle; if empty, every three corners are a triangle.
  std::span<const std::uint32_t> triangles = {};
};

// Returns the area that the charts cover. Where triangles of one chart overlap, the area counts
// once; the result for such a chart is exact to about a hundredth. Errors: bad_input (a triangle
// refers to a corner that does not exist, a number of corners is not a multiple of three, or a
// coordinate is not finite or reaches 1e9).
Result<double> covered_area(std::span<const ChartShape> shapes, const Context& context);

struct OutlineOptions {
  Extent page{2048, 2048};      // in texels; height 0: one page of open height
  std::uint32_t max_pages = 1;  // 0: as many as needed
  double scale = 1;             // texels of the page per texel of a shape; > 0
  // Width of the gutter around each chart in texels; gutters of two charts never overlap.
  std::int32_t padding = 1;
  std::int32_t border = 0;     // free texels along the page's edges, in addition to the padding
  std::int32_t alignment = 1;  // charts own whole cells of alignment × alignment texels
  // Maximum number of directions tried, in multiples of 360/rotations degrees; 1, 2, 4 or a
  // multiple of 4 up to 64.
  std::uint32_t rotations = 4;
  PackPreset preset = PackPreset::standard;
  double time_budget = 1.0;  // of `best`: wall time in seconds
  std::uint64_t effort = 0;  // of `best`: maximum number of layouts that are tried; 0: no limit
  std::uint64_t seed = 1;
};

// The chart point p (texels at scale 1) goes to offset + scale · R(angle) · p in its page.
struct OutlinePlacement {
  std::uint32_t page = kNoPage;
  double angle = 0;  // in radians, counterclockwise
  Vec2d offset = {};
  // The box of the owned cells in texels, padding included; boxes of two charts may overlap.
  Rect box = {};
};

struct OutlineResult {
  std::vector<OutlinePlacement> placements = {};  // one per shape
  std::vector<Extent> pages = {};  // in texels; the height of an open page is the used height
  std::vector<std::uint32_t> unplaced = {};  // shapes that found no room, ascending
  double shape_area = 0;   // area of the placed shapes, in square texels of the page
  double utilization = 0;  // shape_area / area of the pages
  std::uint64_t layouts_tried = 0;
};

// Places the shapes such that no two padded shapes share a cell. A cell belongs to a padded chart
// if the cell's open square, widened by the padding on each side, meets one of the chart's
// triangles. The masks hold exactly these cells.
// Sources: Lévy et al. 2002, section 5 (horizons); docs/packing.md.
// Errors: bad_option, bad_input (as for covered_area), cancelled.
Result<OutlineResult> pack_outlines(std::span<const ChartShape> shapes,
                                    const OutlineOptions& options, const Context& context);

}  // namespace atlas
