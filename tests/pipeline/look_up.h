// Looks images up as graphics hardware does, for tests of what pages hold.
#pragma once

#include <algorithm>
#include <cmath>

#include "libatlas/core/image.h"

namespace atlas::test {

// Returns the bilinear interpolation between the centres of texels, which the edge's continue.
template <class T>
double look_up(const Image<T>& image, double u, double v, int channel) {
  const double x = u * image.width - 0.5, y = v * image.height - 0.5;
  const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
  const auto texel = [&](int i, int j) {
    i = std::clamp(i, 0, image.width - 1);
    j = std::clamp(j, 0, image.height - 1);
    return double(image.at(i, j)[channel]);
  };
  const double fx = x - x0, fy = y - y0;
  return (texel(x0, y0) * (1 - fx) + texel(x0 + 1, y0) * fx) * (1 - fy) +
         (texel(x0, y0 + 1) * (1 - fx) + texel(x0 + 1, y0 + 1) * fx) * fy;
}

}  // namespace atlas::test
