#include <algorithm>

#include "libatlas/bake/texel_grid.h"

namespace atlas {
namespace {

TexelGrid pull(const TexelGrid& fine) {
  TexelGrid coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
  for (int y = 0; y < coarse.height; ++y)
    for (int x = 0; x < coarse.width; ++x) {
      Lanes sum{};
      int n = 0;
      for (int j = 2 * y; j < std::min(2 * y + 2, fine.height); ++j)
        for (int i = 2 * x; i < std::min(2 * x + 2, fine.width); ++i) {
          const std::size_t at = std::size_t(j) * fine.width + i;
          if (!fine.known[at]) continue;
          sum += fine.rgb[at];
          ++n;
        }
      if (n == 0) continue;
      const std::size_t at = std::size_t(y) * coarse.width + x;
      coarse.rgb[at] = sum / static_cast<float>(n);
      coarse.known[at] = 1;
    }
  return coarse;
}

// Unknown texels take the bilinear value of the next coarser level, all of whose texels are filled.
void push(const TexelGrid& coarse, TexelGrid& fine) {
  for (int y = 0; y < fine.height; ++y) {
    const int y0 = y / 2, y1 = std::clamp(y0 + (y & 1 ? 1 : -1), 0, coarse.height - 1);
    for (int x = 0; x < fine.width; ++x) {
      const std::size_t at = std::size_t(y) * fine.width + x;
      if (fine.known[at]) continue;
      const int x0 = x / 2, x1 = std::clamp(x0 + (x & 1 ? 1 : -1), 0, coarse.width - 1);
      const auto c = [&](int i, int j) { return coarse.rgb[std::size_t(j) * coarse.width + i]; };
      fine.rgb[at] = 0.5625f * c(x0, y0) + 0.1875f * (c(x1, y0) + c(x0, y1)) + 0.0625f * c(x1, y1);
    }
  }
}

}  // namespace

std::size_t fill_unknown(TexelGrid& grid) {
  const auto unknown =
      static_cast<std::size_t>(std::count(grid.known.begin(), grid.known.end(), 0));
  if (unknown == 0) return 0;
  if (grid.width > 1 || grid.height > 1) {
    TexelGrid coarse = pull(grid);
    fill_unknown(coarse);
    push(coarse, grid);
  } else {
    grid.rgb[0] = Lanes{};
  }
  return unknown;
}

}  // namespace atlas
