#include "libatlas/bake/ownership.h"

#include <algorithm>

#include "libatlas/raster/coverage.h"

namespace atlas {
namespace {

// Sets every texel that is within `pad` texels of a set one in the same row.
void widen_rows(std::vector<std::uint8_t>& mask, int width, int pad) {
  std::vector<std::uint8_t> row(static_cast<std::size_t>(width));
  for (std::size_t begin = 0; begin < mask.size(); begin += row.size()) {
    const auto first = mask.begin() + static_cast<std::ptrdiff_t>(begin);
    std::copy_n(first, width, row.begin());
    for (int x = 0; x < width; ++x) {
      if (!row[static_cast<std::size_t>(x)]) continue;
      std::fill(first + std::max(0, x - pad), first + std::min(width, x + pad + 1), 1);
    }
  }
}

std::vector<std::uint8_t> transposed(const std::vector<std::uint8_t>& mask, int width, int height) {
  std::vector<std::uint8_t> out(mask.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      out[std::size_t(x) * height + y] = mask[std::size_t(y) * width + x];
  return out;
}

// Sets all texels of each cell that contains a set texel.
void fill_cells(std::vector<std::uint8_t>& mask, const OwnershipGrid& grid) {
  for (int y = 0; y < grid.height; y += grid.cell) {
    const int y1 = std::min(y + grid.cell, grid.height);
    for (int x = 0; x < grid.width; x += grid.cell) {
      const int x1 = std::min(x + grid.cell, grid.width);
      bool any = false;
      for (int j = y; j < y1; ++j)
        for (int i = x; i < x1; ++i) any |= mask[std::size_t(j) * grid.width + i] != 0;
      if (!any) continue;
      for (int j = y; j < y1; ++j)
        for (int i = x; i < x1; ++i) mask[std::size_t(j) * grid.width + i] = 1;
    }
  }
}

// Returns a triangle a little smaller. Charts often end exactly where a cell does. Rounding must
// not let them reach into the next cell then, which the packer may have given to another chart.
TexelTriangle shrunk(const TexelTriangle& t) {
  constexpr double kPart = 1e-8;
  const Vec2d centre{(t[0].x + t[1].x + t[2].x) / 3, (t[0].y + t[1].y + t[2].y) / 3};
  TexelTriangle out;
  for (std::size_t k = 0; k < 3; ++k)
    out[k] = {t[k].x + kPart * (centre.x - t[k].x), t[k].y + kPart * (centre.y - t[k].y)};
  return out;
}

std::vector<std::uint8_t> touched_texels(std::span<const TexelTriangle> triangles,
                                         const OwnershipGrid& grid) {
  std::vector<std::uint8_t> mask(std::size_t(grid.width) * grid.height, 0);
  const Rect all{0, 0, grid.width, grid.height};
  for (const TexelTriangle& triangle : triangles) {
    cover_triangle(shrunk(triangle), all,
                   [&](int x, int y, double, Vec2d) { mask[std::size_t(y) * grid.width + x] = 1; });
  }
  return mask;
}

}  // namespace

std::vector<std::uint8_t> owned_texels(std::span<const TexelTriangle> triangles,
                                       const OwnershipGrid& grid) {
  std::vector<std::uint8_t> mask = touched_texels(triangles, grid);
  widen_rows(mask, grid.width, grid.pad);
  mask = transposed(mask, grid.width, grid.height);
  widen_rows(mask, grid.height, grid.pad);
  mask = transposed(mask, grid.height, grid.width);
  if (grid.cell > 1) fill_cells(mask, grid);
  return mask;
}

// Two sweeps give exact chessboard distances (Rosenfeld and Pfaltz 1968).
std::vector<std::uint16_t> texels_to_triangles(std::span<const TexelTriangle> triangles,
                                               const OwnershipGrid& grid) {
  constexpr int kFar = 65535;
  const std::vector<std::uint8_t> touched = touched_texels(triangles, grid);
  std::vector<std::uint16_t> distance(touched.size());
  for (std::size_t i = 0; i < touched.size(); ++i) distance[i] = touched[i] ? 0 : kFar;
  const auto sweep = [&](int first_y, int step) {
    const auto at = [&](int x, int y) -> std::uint16_t& {
      return distance[std::size_t(y) * std::size_t(grid.width) + std::size_t(x)];
    };
    const int first_x = step > 0 ? 0 : grid.width - 1;
    for (int y = first_y; y >= 0 && y < grid.height; y += step) {
      for (int x = first_x; x >= 0 && x < grid.width; x += step) {
        int least = kFar;
        if (x != first_x) least = at(x - step, y);
        for (int i = std::max(0, x - 1); y != first_y && i <= std::min(grid.width - 1, x + 1); ++i)
          least = std::min<int>(least, at(i, y - step));
        at(x, y) = static_cast<std::uint16_t>(std::min<int>(at(x, y), std::min(least + 1, kFar)));
      }
    }
  };
  sweep(0, 1);
  sweep(grid.height - 1, -1);
  return distance;
}

}  // namespace atlas
