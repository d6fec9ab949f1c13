// Internal: a diffuse texture's mip chain and its bilinear look-up.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "libatlas/core/image.h"
#include "libatlas/scene/scene.h"
#include "libatlas/texture/srgb.h"

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

// Linear RGB at (x, y) in texels of the level, repeating. rgb[3] is left alone.
inline void look_up(const TextureLevels::Level& level, float x, float y, float rgb[4]) {
  const float fx = x - 0.5f, fy = y - 0.5f;
  const float gx = std::floor(fx), gy = std::floor(fy);
  const float tx = fx - gx, ty = fy - gy;
  const auto wrap = [](int a, int n) {
    if (static_cast<unsigned>(a) < static_cast<unsigned>(n)) return a;
    a %= n;
    return a < 0 ? a + n : a;
  };
  const int x0 = wrap(static_cast<int>(gx), level.width),
            y0 = wrap(static_cast<int>(gy), level.height);
  const int x1 = x0 + 1 == level.width ? 0 : x0 + 1, y1 = y0 + 1 == level.height ? 0 : y0 + 1;
  const int c = level.channels, green = c >= 3 ? 1 : 0, blue = c >= 3 ? 2 : 0;
  const auto at = [&](int i, int j) {
    return level.texels + (std::size_t(j) * level.width + i) * c;
  };
  const std::uint8_t *p00 = at(x0, y0), *p10 = at(x1, y0), *p01 = at(x0, y1), *p11 = at(x1, y1);
  const float w11 = tx * ty, w10 = tx - w11, w01 = ty - w11, w00 = 1 - tx - w01;
  const float* decode = srgb_detail::tables.decode;
  rgb[0] =
      w00 * decode[p00[0]] + w10 * decode[p10[0]] + w01 * decode[p01[0]] + w11 * decode[p11[0]];
  rgb[1] = w00 * decode[p00[green]] + w10 * decode[p10[green]] + w01 * decode[p01[green]] +
           w11 * decode[p11[green]];
  rgb[2] = w00 * decode[p00[blue]] + w10 * decode[p10[blue]] + w01 * decode[p01[blue]] +
           w11 * decode[p11[blue]];
}

}  // namespace atlas
