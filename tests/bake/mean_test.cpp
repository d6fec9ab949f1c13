// Compares means over texels with the test's own point samples and integrals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/bake/bake_fixture.h"

namespace atlas {
namespace {

// IEC 61966-2-1.
double encoded_srgb(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

// Calls visit(x, y, weights of the corners) for the points (x + 0.5, y + 0.5) in a triangle, found
// one by one. A point on an edge is in both of its triangles.
template <class Visit>
void each_point_in(const Vec2d (&q)[3], const Visit& visit) {
  const auto cross = [](Vec2d a, Vec2d b, Vec2d p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
  };
  const double area = cross(q[0], q[1], q[2]);
  const auto [x0, x1] = std::minmax({q[0].x, q[1].x, q[2].x});
  const auto [y0, y1] = std::minmax({q[0].y, q[1].y, q[2].y});
  for (int y = int(std::ceil(y0 - 0.5)); y + 0.5 <= y1; ++y)
    for (int x = int(std::ceil(x0 - 0.5)); x + 0.5 <= x1; ++x) {
      const Vec2d p{x + 0.5, y + 0.5};
      const double b[3] = {cross(q[1], q[2], p) / area, cross(q[2], q[0], p) / area,
                           cross(q[0], q[1], p) / area};
      if (b[0] >= 0 && b[1] >= 0 && b[2] >= 0) visit(x, y, b);
    }
}

TEST(BakePage, AverageIsTheAreaMeanOverEachTexel) {
  // Compares values that jump from vertex to vertex, on triangles of 0.1 to 3 texels, with many
  // point samples.
  for (const int cells : {8, 30, 90}) {
    std::mt19937 random(6);
    const LitShape shape = make_sheet({1, 1, cells, cells, 0.25}, [&](double, double) {
      return Vec3f{(random() % 100) / 100.0f, 0, 0};
    });
    const ChartPlacement p = place(shape.charts, 0, {24, 24}, {2, 2});
    BakeOptions options = small_page(32, BakeMethod::average);
    options.shifts = 1;
    options.mip_levels = 0;
    const auto page = bake(shape, {p}, options);
    ASSERT_TRUE(page.ok());
    // The expected value is the mean of 40 x 40 point samples per texel.
    constexpr int kSide = 40;
    std::vector<double> sum(24 * 24), count(24 * 24);
    for (std::size_t t = 0; t < shape.scene.triangle_count(); ++t) {
      Vec2d q[3];
      double e[3];
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t v = shape.scene.indices[3 * t + k];
        q[k] = {shape.charts.uvs[v].x * 24 * kSide, shape.charts.uvs[v].y * 24 * kSide};
        e[k] = shape.scene.illumination[v].x;
      }
      each_point_in(q, [&](int x, int y, const double(&b)[3]) {
        const std::size_t at = std::size_t(y / kSide) * 24 + x / kSide;
        sum[at] += encoded_srgb(b[0] * e[0] + b[1] * e[1] + b[2] * e[2]);
        count[at] += 1;
      });
    }
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 24; ++x) {
        const double want = sum[y * 24 + x] / count[y * 24 + x];
        // The baker takes a part's value at its centroid, which is exact except for the curve of
        // the display encoding.
        ASSERT_NEAR(page->display.at(x + 2, y + 2)[0] / 255.0, want, 6.0 / 255)
            << cells << ' ' << x << ' ' << y;
      }
  }
}

TEST(BakePage, CountsEveryTriangleHoweverSmall) {
  // A texel has a hundred cells, and one column in five is bright. Each texel must be near the
  // mean, whatever the positions of the samples.
  const int n = 200;
  const LitShape shape = make_sheet({1, 1, n, n}, [&](double u, double) {
    const int column = static_cast<int>(std::lround(u * n));
    return shown(column % 5 == 0 ? 1.0 : 0.2);
  });
  // Of five columns of cells, two change between bright and dark, linearly in light, and three are
  // dark. Computes the mean of their display values by the midpoint rule.
  const double dark = std::pow((0.2 + 0.055) / 1.055, 2.4);
  constexpr int kSteps = 100000;
  double changing = 0;
  for (int i = 0; i < kSteps; ++i)
    changing += encoded_srgb(dark + (1 - dark) * (i + 0.5) / kSteps) / kSteps;
  const double mean = 255 * (2 * changing + 3 * 0.2) / 5;
  for (const BakeMethod method : {BakeMethod::least_squares, BakeMethod::average})
    for (const int shifts : {1, 4}) {
      const ChartPlacement p = place(shape.charts, 0, {20, 20}, {4, 4});
      BakeOptions options = small_page(32, method);
      options.shifts = shifts;
      const auto page = bake(shape, {p}, options);
      ASSERT_TRUE(page.ok());
      for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 20; ++x)
          ASSERT_NEAR(page->display.at(x + 4, y + 4)[0], mean, 6) << shifts << ' ' << x << ' ' << y;
    }
}

}  // namespace
}  // namespace atlas
