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

// The texel, of n, that stands for texel i.
inline int wrapped(int i, int n, TextureWrap wrap) {
  if (static_cast<unsigned>(i) < static_cast<unsigned>(n)) return i;
  if (wrap == TextureWrap::clamp) return i < 0 ? 0 : n - 1;
  const int period = wrap == TextureWrap::mirror ? 2 * n : n;
  i %= period;
  if (i < 0) i += period;
  return i < n ? i : period - 1 - i;
}

// How both coordinates go on outside the texture.
struct TextureWraps {
  TextureWrap u = TextureWrap::repeat, v = TextureWrap::repeat;
};

// Linear RGB at (x, y) in texels of the level; the 4th lane is about 1.
inline Lanes look_up(const TextureLevels::Level& level, Vec2f at_texel, TextureWraps wraps) {
  // Floor by truncation: coordinates are at most a few repeats below 0 and far from overflow.
  const auto floor_of = [](float v) {
    const int i = static_cast<int>(v);
    return i - (v < static_cast<float>(i));
  };
  const float fx = at_texel.x - 0.5f, fy = at_texel.y - 0.5f;
  const int gx = floor_of(fx), gy = floor_of(fy);
  const float tx = fx - static_cast<float>(gx), ty = fy - static_cast<float>(gy);
  const int x0 = wrapped(gx, level.width, wraps.u), y0 = wrapped(gy, level.height, wraps.v);
  const int x1 = wrapped(gx + 1, level.width, wraps.u), y1 = wrapped(gy + 1, level.height, wraps.v);
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
