#include <algorithm>
#include <cstring>

#include "libatlas/raster/texel_grid.h"

namespace atlas {
namespace {

using Known = std::vector<std::uint8_t>;

// Returns the next coarser level of a grid or page. Its texels are the means of the known texels of
// the finer level, whose colours colour(at) returns.
template <class Fine, class Colour>
TexelGrid pull(const Fine& fine, const Known& known, Colour&& colour) {
  TexelGrid coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
  const auto width = static_cast<std::size_t>(fine.width);
  std::size_t to = 0;
  for (int y = 0; y < coarse.height; ++y)
    for (int x = 0; x < coarse.width; ++x, ++to) {
      const std::size_t at = std::size_t(2 * y) * width + std::size_t(2 * x);
      const bool two = 2 * x + 1 < fine.width, rows = 2 * y + 1 < fine.height;
      if (two && rows && (known[at] & known[at + 1] & known[at + width] & known[at + width + 1])) {
        coarse.rgb[to] =
            (colour(at) + colour(at + 1) + colour(at + width) + colour(at + width + 1)) * 0.25f;
        coarse.known[to] = 1;
        continue;
      }
      Lanes sum{};
      int n = 0;
      for (std::size_t j = 0; j < (rows ? 2 : 1); ++j)
        for (std::size_t i = at + j * width; i < at + j * width + (two ? 2 : 1); ++i) {
          if (!known[i]) continue;
          sum += colour(i);
          ++n;
        }
      if (n == 0) continue;
      coarse.rgb[to] = sum / static_cast<float>(n);
      coarse.known[to] = 1;
    }
  return coarse;
}

// Gives unknown texels the bilinearly interpolated value of the next coarser level, all of whose
// texels are filled.
template <class Fine, class Set>
void push(const TexelGrid& coarse, const Fine& fine, const Known& known, Set&& set) {
  for (int y = 0; y < fine.height; ++y) {
    const int y0 = y / 2, y1 = std::clamp(y0 + (y & 1 ? 1 : -1), 0, coarse.height - 1);
    const std::size_t from = std::size_t(y) * static_cast<std::size_t>(fine.width);
    for (int x = 0; x < fine.width; ++x) {
      const std::uint8_t* here = &known[from + std::size_t(x)];
      if (*here) {  // skip to the next unknown texel
        const void* next = std::memchr(here, 0, static_cast<std::size_t>(fine.width - x));
        if (!next) break;
        x += static_cast<int>(static_cast<const std::uint8_t*>(next) - here);
      }
      const int x0 = x / 2, x1 = std::clamp(x0 + (x & 1 ? 1 : -1), 0, coarse.width - 1);
      const auto c = [&](int i, int j) { return coarse.rgb[std::size_t(j) * coarse.width + i]; };
      set(from + std::size_t(x),
          0.5625f * c(x0, y0) + 0.1875f * (c(x1, y0) + c(x0, y1)) + 0.0625f * c(x1, y1));
    }
  }
}

}  // namespace

std::size_t fill_unknown(TexelGrid& grid) {
  const auto unknown =
      static_cast<std::size_t>(std::count(grid.known.begin(), grid.known.end(), 0));
  if (unknown == 0) return 0;
  if (grid.width > 1 || grid.height > 1) {
    TexelGrid coarse = pull(grid, grid.known, [&](std::size_t at) { return grid.rgb[at]; });
    fill_unknown(coarse);
    push(coarse, grid, grid.known, [&](std::size_t at, Lanes rgb) { grid.rgb[at] = rgb; });
  } else {
    grid.rgb[0] = Lanes{};
  }
  return unknown;
}

void fill_unknown(const std::vector<std::uint8_t>& known, Image8& page) {
  if (std::find(known.begin(), known.end(), 0) == known.end()) return;
  TexelGrid coarse = pull(page, known, [&](std::size_t at) {
    const std::uint8_t* t = &page.texels[3 * at];
    return __builtin_convertvector(IntLanes{t[0], t[1], t[2], 0}, Lanes) / 255.0f;
  });
  fill_unknown(coarse);
  push(coarse, page, known, [&](std::size_t at, Lanes rgb) {
    for (std::size_t k = 0; k < 3; ++k) page.texels[3 * at + k] = quantize8(rgb[k]);
  });
}

}  // namespace atlas
