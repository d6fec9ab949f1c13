// Internal: adds the samples of triangles to the equations of LeastSquares.
#pragma once

#include <algorithm>
#include <vector>

#include "libatlas/raster/least_squares.h"
#include "libatlas/raster/sampling.h"

namespace atlas {

// The samples of one grid, relative to the texels that they lie in: their bilinear weights, and the
// lower left of the four texels around a sample, relative to the texel that contains it.
struct GridSplat {
  int left, low;
  LeastSquares::Splat splat;

  GridSplat(Vec2d offset, float weight)
      : left(offset.x < 0.5 ? -1 : 0),
        low(offset.y < 0.5 ? -1 : 0),
        splat(static_cast<float>(offset.x - 0.5 - left), static_cast<float>(offset.y - 0.5 - low),
              weight) {}
};

inline std::vector<GridSplat> grid_splats(const SampleGrid& grid) {
  std::vector<GridSplat> splats;
  for (int k = 0; k < grid.count; ++k)
    splats.emplace_back(grid.offset[k], 1.0f / static_cast<float>(grid.count));
  return splats;
}

// The sample grids, the weights of their samples, and the equations that samples are added to.
struct Samples {
  const SampleGrid& grid;
  const std::vector<GridSplat>& splats;
  LeastSquares& fit;
};

// Adds a triangle's samples to the equations. The centre of texel (0, 0) is at (0.5, 0.5). Of
// values, at(barycentric coordinates) gives the colour with a 1 in the 4th lane, and row(at, n,
// take) calls take(first, colours, count) for stretches of the samples (at.x + i, at.y), 0 <= i <
// n.
template <class Values>
void splat_triangle(const TexelTriangle& p, const Values& values, const Samples& samples) {
  LeastSquares& fit = samples.fit;
  const auto row = [&](int k, int y, int x0, int x1) {
    const Vec2d o = samples.grid.offset[k];
    const GridSplat& s = samples.splats[static_cast<std::size_t>(k)];
    values.row({x0 + o.x, y + o.y}, x1 - x0, [&](int first, const Lanes* rgb, int n) {
      fit.add_row({x0 + s.left + first, y + s.low, s.splat}, rgb, n);
    });
  };
  const auto point = [&](const float* b, float area) {
    const double x = b[0] * p[0].x + b[1] * p[1].x + b[2] * p[2].x - 0.5;
    const double y = b[0] * p[0].y + b[1] * p[1].y + b[2] * p[2].y - 0.5;
    const int i = std::clamp(static_cast<int>(x), 0, fit.width() - 2);
    const int j = std::clamp(static_cast<int>(y), 0, fit.height() - 2);
    const LeastSquares::Splat splat(static_cast<float>(std::clamp(x - i, 0.0, 1.0)),
                                    static_cast<float>(std::clamp(y - j, 0.0, 1.0)), area);
    fit.add(i, j, splat, values.at(b));
  };
  sample_triangle(p, {1, 1, fit.width() - 2, fit.height() - 2}, samples.grid,
                  SampleVisitor{row, point});
}

}  // namespace atlas
