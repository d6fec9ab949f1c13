// Internal: a diffuse texture's mip chain and its bilinear look-up.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/core/image.h"
#include "libatlas/core/lanes.h"
#include "libatlas/scene/scene.h"

namespace atlas {

// 8-bit sRGB-encoded levels, each half of the one before, averaged in linear light. Level 0 is the
// scene's own image.
struct TextureLevels {
  struct Level {
    int width = 0, height = 0, channels = 0;
    const std::uint8_t* texels = nullptr;
    const Lanes* decoded = nullptr;  // linear RGB and 1 of each texel, where there is room for it
  };
  std::vector<Level> levels;
  std::vector<Image8> storage;                      // of levels 1 and up
  std::vector<std::vector<Lanes>> decoded_storage;  // of each level, after decode()

  explicit TextureLevels(const Texture& texture);
  std::size_t texels() const;  // the number of texels of all levels
  void decode();
};

// Returns the index, from 0 to n - 1, of the texel that a lookup of texel i reads in a row of n
// texels.
inline int wrapped(int i, int n, TextureWrap wrap) {
  if (static_cast<unsigned>(i) < static_cast<unsigned>(n)) return i;
  if (wrap == TextureWrap::clamp) return i < 0 ? 0 : n - 1;
  const int period = wrap == TextureWrap::mirror ? 2 * n : n;
  i %= period;
  if (i < 0) i += period;
  return i < n ? i : period - 1 - i;
}

// How the texture continues beyond its edges, for each coordinate.
struct TextureWraps {
  TextureWrap u = TextureWrap::repeat, v = TextureWrap::repeat;
};

// A position in a texture: the lower left of the four texels around it, and the position's share of
// the way to the texels on the right and above.
struct TexturePosition {
  int left, low;
  float right_share, high_share;
};

// Two ways to read the texel of a level at an index: DecodedTexels were decoded before,
// EncodedTexels are decoded when they are read.
struct DecodedTexels {
  const Lanes* texels;
  Lanes operator()(std::size_t at) const { return texels[at]; }
};
struct EncodedTexels {
  const std::uint8_t* texels;
  std::size_t channels;
  Lanes operator()(std::size_t at) const {
    const float* decode = srgb_detail::tables.decode;
    const std::uint8_t* t = texels + at * channels;
    const std::size_t green = channels >= 3 ? 1 : 0;
    return Lanes{decode[t[0]], decode[t[green]], decode[t[2 * green]], 1};
  }
};

// Returns linear RGB, interpolated between four texels. The 4th lane is about 1.
template <class Texels>
Lanes bilinear(const TextureLevels::Level& level, const Texels& texel, const TexturePosition& p,
               TextureWraps wraps) {
  int x0 = p.left, x1 = p.left + 1, y0 = p.low, y1 = p.low + 1;
  if (static_cast<unsigned>(x0) >= static_cast<unsigned>(level.width - 1)) {
    x0 = wrapped(x0, level.width, wraps.u);
    x1 = wrapped(x1, level.width, wraps.u);
  }
  if (static_cast<unsigned>(y0) >= static_cast<unsigned>(level.height - 1)) {
    y0 = wrapped(y0, level.height, wraps.v);
    y1 = wrapped(y1, level.height, wraps.v);
  }
  const auto width = static_cast<std::size_t>(level.width);
  const std::size_t lower = static_cast<std::size_t>(y0) * width;
  const std::size_t upper = static_cast<std::size_t>(y1) * width;
  const auto left = static_cast<std::size_t>(x0), right = static_cast<std::size_t>(x1);
  const Lanes a = texel(lower + left), b = texel(lower + right);
  const Lanes c = texel(upper + left), d = texel(upper + right);
  const Lanes low = a + p.right_share * (b - a), high = c + p.right_share * (d - c);
  return low + p.high_share * (high - low);
}

// Calls use() with the texels of a level, decoded ones if the level has them.
template <class Use>
auto with_texels(const TextureLevels::Level& level, Use&& use) {
  if (level.decoded) return use(DecodedTexels{level.decoded});
  return use(EncodedTexels{level.texels, static_cast<std::size_t>(level.channels)});
}

// Looks up the texture at a position in texels of the level.
inline Lanes look_up(const TextureLevels::Level& level, Vec2f at_texel, TextureWraps wraps) {
  // The floor is computed by truncation. Coordinates are at most a few repeats below 0 and far from
  // overflow.
  const auto floor_of = [](float v) {
    const int i = static_cast<int>(v);
    return i - (v < static_cast<float>(i));
  };
  const float x = at_texel.x - 0.5f, y = at_texel.y - 0.5f;
  const int left = floor_of(x), low = floor_of(y);
  const TexturePosition p{left, low, x - static_cast<float>(left), y - static_cast<float>(low)};
  return with_texels(level, [&](const auto& texels) { return bilinear(level, texels, p, wraps); });
}

}  // namespace atlas
