// A lit shape that is placed by hand on one page, and look-ups as a viewer makes them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "libatlas/bake/bake.h"
#include "libatlas/core/srgb.h"
#include "tests/support/lit_shapes.h"

namespace atlas {

// Display values are the sRGB encoding of luminance; white is 1.
inline const ToneMapping kPlain{};

inline Vec3f shown(double d) {
  const float v = srgb_decode(static_cast<float>(d));
  return {v, v, v};
}

// The lower left corner of a chart's inner box.
struct Spot {
  std::int32_t x, y;
  bool rotated = false;
};

inline ChartPlacement place(const ChartSet& charts, std::uint32_t id, Vec2d density, Spot at) {
  ChartPlacement p;
  p.chart = id;
  p.page = 0;
  p.x = at.x;
  p.y = at.y;
  p.texels_per_unit = density;
  const TexelSize size = texel_size(charts.charts[id].size, density);
  p.width = at.rotated ? size.height : size.width;
  p.height = at.rotated ? size.width : size.height;
  turn_in_box(p, at.rotated);
  return p;
}

inline Result<BakedPage> bake(const LitShape& shape, const std::vector<ChartPlacement>& placements,
                              const BakeOptions& options, int threads = 1) {
  const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
  Context context;
  context.threads = threads;
  return bake_page({sampler, shape.charts, kPlain}, placements, options, context);
}

inline BakeOptions small_page(int side, BakeMethod method = BakeMethod::least_squares) {
  BakeOptions o;
  o.page_width = o.page_height = side;
  o.method = method;
  return o;
}

// A bilinear look-up at a page position in texels. Returns the value as stored.
template <class T>
double look_up(const Image<T>& image, Vec2d at, int channel) {
  const double x = at.x - 0.5, y = at.y - 0.5;
  const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  const double tx = x - x0, ty = y - y0;
  const auto texel = [&](int i, int j) -> double {
    i = std::clamp(i, 0, image.width - 1);
    j = std::clamp(j, 0, image.height - 1);
    return image.at(i, j)[channel];
  };
  return (1 - ty) * ((1 - tx) * texel(x0, y0) + tx * texel(x0 + 1, y0)) +
         ty * ((1 - tx) * texel(x0, y0 + 1) + tx * texel(x0 + 1, y0 + 1));
}

}  // namespace atlas
