// Internal: a diffuse texture's mip chain and its bilinear look-up.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/core/image.h"
#include "libatlas/scene/scene.h"
#include "libatlas/texture/lanes.h"

namespace atlas {

// 8-bit sRGB-encoded levels, each half of the one before, averaged in linear light. Level 0 is the
// scene's own image.
struct TextureLevels {
  struct Level {
    int width = 0, height = 0, channels = 0;
    const std::uint8_t* texels = nullptr;
  };
  std::vector<Level> levels;
  std::vector<Image8> storage;  // of levels 1 and up

  explicit TextureLevels(const Texture& texture);
};

// Linear RGB at (x, y) in texels of the level, repeating; the 4th lane is about 1.
inline Lanes look_up(const TextureLevels::Level& level, float x, float y) {
  // Floor by truncation: coordinates are at most a few repeats below 0 and far from overflow.
  const auto floor_of = [](float v) {
    const int i = static_cast<int>(v);
    return i - (v < static_cast<float>(i));
  };
  const float fx = x - 0.5f, fy = y - 0.5f;
  const int gx = floor_of(fx), gy = floor_of(fy);
  const float tx = fx - static_cast<float>(gx), ty = fy - static_cast<float>(gy);
  const auto wrap = [](int a, int n) {
    if (static_cast<unsigned>(a) < static_cast<unsigned>(n)) return a;
    a %= n;
    return a < 0 ? a + n : a;
  };
  const int x0 = wrap(gx, level.width), y0 = wrap(gy, level.height);
  const int x1 = x0 + 1 == level.width ? 0 : x0 + 1, y1 = y0 + 1 == level.height ? 0 : y0 + 1;
  const int c = level.channels, green = c >= 3 ? 1 : 0, blue = c >= 3 ? 2 : 0;
  const float* decode = srgb_detail::tables.decode;
  const auto at = [&](int i, int j) {
    const std::uint8_t* p = level.texels + (std::size_t(j) * level.width + i) * c;
    return Lanes{decode[p[0]], decode[p[green]], decode[p[blue]], 1};
  };
  const Lanes low = at(x0, y0) + tx * (at(x1, y0) - at(x0, y0));
  const Lanes high = at(x0, y1) + tx * (at(x1, y1) - at(x0, y1));
  return low + ty * (high - low);
}

}  // namespace atlas
