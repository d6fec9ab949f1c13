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

// A flat chart: a soup of triangles, 3 corners each, in texels at scale 1 (any origin, finite,
// either orientation). What it points at must outlive it. No triangle: takes no room.
struct ChartShape {
  std::span<const Vec2d> corners;            // the vertices
  std::span<const std::uint32_t> triangles;  // 3 a triangle into corners; empty: corners are
                                             // taken three by three
};

// The area that the charts cover, triangles of a chart that lie on each other counted once: within
// a hundredth or so of a chart's where some do. Errors: bad_input (a triangle's corner that is not
// there, or one that is not finite).
Result<double> covered_area(std::span<const ChartShape> shapes, const Context& context);

struct OutlineOptions {
  Extent page{2048, 2048};      // texels; height 0: one page of open height
  std::uint32_t max_pages = 1;  // 0: as many as it takes
  double scale = 1;             // texels of page per texel of shape, > 0
  std::int32_t padding = 1;     // texels around each chart that no other chart's padding touches
  std::int32_t border = 0;      // free texels along the page's edges beyond the padding
  std::int32_t alignment = 1;   // charts own whole cells of alignment × alignment texels
  std::uint32_t rotations = 4;  // directions tried: multiples of 360/rotations degrees
  PackPreset preset = PackPreset::standard;
  double time_budget = 1.0;  // of `best`, wall seconds
  std::uint64_t effort = 0;  // of `best`: layouts tried at most; 0: no limit
  std::uint64_t seed = 1;
};

// Chart point p (texels at scale 1) goes to offset + scale · R(angle) · p in its page.
struct OutlinePlacement {
  std::uint32_t page = kNoPage;
  double angle = 0;  // radians, counterclockwise
  Vec2d offset;
  Rect box;  // cells owned, as texels, padding included; boxes of two charts may overlap
};

struct OutlineResult {
  std::vector<OutlinePlacement> placements;  // 1 a shape
  std::vector<Extent> pages;                 // texels; an open page's height is what was used
  std::vector<std::uint32_t> unplaced;       // shapes without room, ascending
  double shape_area = 0;                     // of the placed shapes, texels² of page
  double utilization = 0;                    // shape_area / area of the pages
  std::uint64_t layouts_tried = 0;
  std::vector<PackProgress> curve;
};

// Places every shape such that no two padded shapes share a cell. "Padded" is exact: a cell
// belongs to a chart if it touches (shares a point of positive distance < padding in the maximum
// norm with) one of its triangles.
// Sources: Lévy et al. 2002, section 5 (horizons); docs/packing.md.
// Errors: bad_option, bad_input (a coordinate is not finite), cancelled.
Result<OutlineResult> pack_outlines(std::span<const ChartShape> shapes,
                                    const OutlineOptions& options, const Context& context);

}  // namespace atlas
