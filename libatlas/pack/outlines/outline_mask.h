// Internal: a chart's mask, which is its shape on the cell grid as runs of cells row by row.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/pack/outlines/chart_outline.h"

namespace atlas::pack {

// The cells [begin, end) of a row.
struct Run {
  std::int32_t begin = 0, end = 0;
  bool operator==(const Run&) const = default;
};

// Rows are numbered 0 .. height - 1 from the bottom. The runs of row r are runs[first[r]] ..
// runs[first[r + 1] - 1]. They are in ascending order, not empty, and do not touch. The box is
// tight.
struct Mask {
  std::int32_t width = 0, height = 0;
  std::vector<std::uint32_t> first;
  std::vector<Run> runs;
  std::int64_t cells = 0;

  std::span<const Run> row(std::int32_t r) const {
    return {runs.data() + first[r], runs.data() + first[r + 1]};
  }
  bool operator==(const Mask&) const = default;
};

// How a chart is mapped to the cell grid: the chart point p lies at origin + factor · R(angle) · p
// texels from the lower left corner of the mask's box.
struct RasterOptions {
  double factor = 1, angle = 0;
  std::int32_t padding = 1, cell = 1;
  // How far the chart's lower left corner lies beyond the padding, texels, 0 .. cell: for charts
  // that must keep their place between the cells of a page.
  Vec2d shift = {};
};

// Returns all cells whose open square, widened by the padding on each side, meets a triangle. A
// chart that has corners but no area still owns the cells around the corners. A chart without
// corners gets an empty mask. `origin` receives the origin of RasterOptions.
Mask rasterize(const ChartOutline& outline, const RasterOptions& options, Vec2d& origin);

// Returns the mask turned by 90 degrees counterclockwise.
Mask quarter_turn(const Mask& mask);

// Returns the mask turned by 180 degrees. This takes far less work than a quarter turn.
Mask half_turn(const Mask& mask);

// Returns whether a cell of `a` coincides with one of `b` if b is put dx cells to the right of a
// and dy cells above it.
bool overlap(const Mask& a, const Mask& b, std::int32_t dx, std::int32_t dy);

struct MaskAt {
  const Mask& mask;
  std::int32_t x = 0, y = 0;  // cells to the right and above
};

// Returns the cells of all masks.
Mask join(std::span<const MaskAt> masks);

// Returns the mask on cells that are `factor` times as large: every large cell that contains a cell
// of the mask.
Mask coarsen(const Mask& mask, std::int32_t factor);

}  // namespace atlas::pack
