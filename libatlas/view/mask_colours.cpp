#include "libatlas/view/mask_colours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace atlas {
namespace {

using Colour = std::array<float, 4>;  // sum of colours, and how many they are

// Sums over squares of 2^n texels a side, in rows.
struct Level {
  int width, height;
  std::vector<Colour> sums;
  Level(int w, int h) : width(w), height(h), sums(std::size_t(w) * std::size_t(h)) {}
  Colour& at(int x, int y) { return sums[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
};

void add(Colour& to, const Colour& from) {
  for (std::size_t i = 0; i < 4; ++i) to[i] += from[i];
}

Level halved(Level& fine) {
  Level coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x) add(coarse.at(x / 2, y / 2), fine.at(x, y));
  return coarse;
}

}  // namespace

void spread_mask_colours(std::span<std::uint8_t> rgba, int width, int height, int least) {
  const auto texel = [&](int x, int y) {
    return rgba.data() + 4 * (std::size_t(y) * std::size_t(width) + std::size_t(x));
  };
  std::vector<Level> levels;
  levels.emplace_back((width + 1) / 2, (height + 1) / 2);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (const std::uint8_t* t = texel(x, y); t[3] >= least)
        add(levels[0].at(x / 2, y / 2), {float(t[0]), float(t[1]), float(t[2]), 1});
  while (levels.back().width > 1 || levels.back().height > 1)
    levels.push_back(halved(levels.back()));
  if (levels.back().sums[0][3] == 0) return;
  for (std::size_t n = levels.size() - 1; n-- > 0;)
    for (int y = 0; y < levels[n].height; ++y)
      for (int x = 0; x < levels[n].width; ++x)
        if (Colour& sum = levels[n].at(x, y); sum[3] == 0) sum = levels[n + 1].at(x / 2, y / 2);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      std::uint8_t* t = texel(x, y);
      if (t[3] >= least) continue;
      const Colour& sum = levels[0].at(x / 2, y / 2);
      for (std::size_t i = 0; i < 3; ++i) t[i] = std::uint8_t(std::lround(sum[i] / sum[3]));
    }
}

}  // namespace atlas
