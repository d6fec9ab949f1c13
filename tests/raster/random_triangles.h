// Triangles of every size and aspect, some with corners on the grid.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "libatlas/raster/scan.h"

namespace atlas {

inline std::vector<TexelTriangle> random_triangles(int count, unsigned seed, double span) {
  std::mt19937 random(seed);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  std::vector<TexelTriangle> out;
  for (int i = 0; i < count; ++i) {
    const double size = std::pow(10.0, uniform(-2, std::log10(span)));
    const Vec2d centre{uniform(0, span), uniform(0, span)};
    TexelTriangle t;
    for (Vec2d& c : t) c = {centre.x + uniform(-size, size), centre.y + uniform(-size, size)};
    if (i % 5 == 0)  // needles
      t[2] = {t[0].x + uniform(0, 1) * (t[1].x - t[0].x) + uniform(-1e-3, 1e-3),
              t[0].y + uniform(0, 1) * (t[1].y - t[0].y) + uniform(-1e-3, 1e-3)};
    if (i % 7 == 0)  // corners on texel corners and centres
      for (Vec2d& c : t) c = {std::round(2 * c.x) / 2, std::round(2 * c.y) / 2};
    if (i % 11 == 0) t[1].y = t[0].y;  // a horizontal edge
    out.push_back(t);
  }
  return out;
}

}  // namespace atlas
