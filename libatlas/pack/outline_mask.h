// Internal: a chart's shape on the cell grid, as runs of cells row by row.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/pack/chart_outline.h"

namespace atlas::pack {

// Cells [begin, end) of a row.
struct Run {
  std::int32_t begin = 0, end = 0;
  bool operator==(const Run&) const = default;
};

// Rows 0 .. height - 1 from the bottom; the runs of row r are runs[first[r]] .. runs[first[r + 1]],
// ascending, neither empty nor touching. The box is tight.
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

// How a chart meets the cell grid: chart point p lies at origin + factor · R(angle) · p texels from
// the lower left corner of the mask's box.
struct RasterOptions {
  double factor = 1, angle = 0;
  std::int32_t padding = 1, cell = 1;
};

// All cells whose open square, widened by the padding on each side, meets a triangle. A chart with
// corners but without area still owns the cells around them. No corner: an empty mask.
Mask rasterize(const ChartOutline& outline, const RasterOptions& options, Vec2d& origin);

// The mask turned by 90 degrees counterclockwise.
Mask quarter_turn(const Mask& mask);

// By 180 degrees: far less work.
Mask half_turn(const Mask& mask);

// Whether a cell of `a` lies on one of `b` when b is put dx, dy cells right of and above a.
bool overlap(const Mask& a, const Mask& b, std::int32_t dx, std::int32_t dy);

// The mask on cells `factor` times as large: every cell that holds one of the mask.
Mask coarsen(const Mask& mask, std::int32_t factor);

}  // namespace atlas::pack
