#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "libatlas/param/distortion.h"
#include "libatlas/param/mesh/percentile.h"
#include "tests/param/shapes.h"

namespace atlas {
namespace {

using testing::Disc;

// Returns Sander's singular values by an independent method: from the eigenvalues of the Gram
// matrix of the two partial derivatives.
std::array<double, 2> sander(const Disc& d, std::span<const Vec2d> uv, std::size_t t) {
  const auto& tri = d.triangles[t];
  const Vec2d a = uv[tri[0]], b = uv[tri[1]], c = uv[tri[2]];
  const double twice = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
  const auto partial = [&](double wa, double wb, double wc) {
    const Vec3d p = d.positions[tri[0]], q = d.positions[tri[1]], r = d.positions[tri[2]];
    return Vec3d{(p.x * wa + q.x * wb + r.x * wc) / twice, (p.y * wa + q.y * wb + r.y * wc) / twice,
                 (p.z * wa + q.z * wb + r.z * wc) / twice};
  };
  const Vec3d s = partial(b.y - c.y, c.y - a.y, a.y - b.y);
  const Vec3d u = partial(c.x - b.x, a.x - c.x, b.x - a.x);
  const auto dot = [](Vec3d x, Vec3d y) { return x.x * y.x + x.y * y.y + x.z * y.z; };
  const double e = dot(s, s), f = dot(s, u), g = dot(u, u);
  const double root = std::sqrt((e - g) * (e - g) + 4 * f * f);
  return {std::sqrt((e + g + root) / 2), std::sqrt(std::max(0.0, (e + g - root) / 2))};
}

Disc bumpy(std::uint32_t n) {
  return testing::make_grid(n, n, [](double u, double v) {
    return Vec3d{u, v, 0.2 * std::sin(5 * u) * std::cos(4 * v)};
  });
}

std::vector<Vec2d> flat(const Disc& d, double noise = 0) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> shift(-noise, noise);
  std::vector<Vec2d> uv;
  for (const Vec3d& p : d.positions) uv.push_back({p.x + shift(random), p.y + shift(random)});
  return uv;
}

TEST(Distortion, LinearMapsHaveTheirSingularValues) {
  const Disc d = testing::make_grid(4, 3, [](double u, double v) { return Vec3d{u, v, 0}; });
  std::vector<Vec2d> uv;
  for (const Vec3d& p : d.positions) uv.push_back({2 * p.x, 0.5 * p.y});
  std::vector<TriangleStretch> s(d.triangles.size());
  measure_triangles(d.view(), uv, s);
  for (const TriangleStretch& t : s) {
    EXPECT_FLOAT_EQ(t.s1, 2.0f);
    EXPECT_FLOAT_EQ(t.s2, 0.5f);
  }
  const Distortion m = measure_distortion(d.view(), uv);
  EXPECT_NEAR(m.stretch_l2, std::sqrt((4 + 0.25) / 2), 1e-6);
  EXPECT_NEAR(m.stretch_linf, 2, 1e-6);
  EXPECT_NEAR(m.conformal_mean, 4, 1e-5);
  EXPECT_NEAR(m.conformal_max, 4, 1e-5);
  EXPECT_NEAR(m.area_min, 1, 1e-6);
  EXPECT_NEAR(m.uv_area, 1, 1e-12);
  EXPECT_EQ(m.flips, 0u);
}

TEST(Distortion, AgreesWithTheGramMatrix) {
  const Disc d = bumpy(20);
  const auto uv = flat(d, 0.01);
  std::vector<TriangleStretch> s(d.triangles.size());
  measure_triangles(d.view(), uv, s);
  double area = 0, uv_area = 0, l2 = 0;
  for (std::size_t t = 0; t < s.size(); ++t) {
    const auto expected = sander(d, uv, t);
    EXPECT_NEAR(s[t].s1, expected[0], 1e-5 * expected[0]);
    EXPECT_NEAR(s[t].s2, expected[1], 1e-5 * expected[1]);
    area += s[t].area;
    uv_area += std::abs(s[t].uv_area);
    l2 += s[t].area * (expected[0] * expected[0] + expected[1] * expected[1]) / 2;
  }
  EXPECT_NEAR(measure_distortion(d.view(), uv).stretch_l2, std::sqrt(l2 / area * uv_area / area),
              1e-5);
}

TEST(Distortion, PercentileIsTheSortedOne) {
  const Disc d = bumpy(60);
  const auto uv = flat(d, 0.004);
  std::vector<double> stretch(d.triangles.size());
  std::vector<TriangleStretch> s(d.triangles.size());
  const Distortion m = measure_distortion(d.view(), uv, stretch);
  measure_triangles(d.view(), uv, s);
  std::vector<std::pair<double, double>> sorted;
  double area = 0;
  for (std::size_t t = 0; t < s.size(); ++t) {
    if (std::isfinite(stretch[t])) sorted.push_back({stretch[t], s[t].area});
    area += s[t].area;
  }
  std::sort(sorted.begin(), sorted.end());
  double below = 0;
  for (const auto& [value, weight] : sorted) {
    below += weight;
    if (below < 0.999 * area) continue;
    EXPECT_NEAR(m.stretch_999, value, 1e-5 * value);
    break;
  }
  EXPECT_GE(m.stretch_linf, m.stretch_999);
}

TEST(Distortion, CountsFlippedAndDegenerate) {
  Disc d;
  d.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 2, 2}};
  d.triangles = {{0, 1, 2}, {1, 3, 2}, {2, 3, 4}};
  const std::vector<Vec2d> uv = {{0, 0}, {1, 0}, {0, 1}, {-0.5, 0.5}, {-0.25, 0.75}};
  std::vector<double> stretch(3);
  const Distortion m = measure_distortion(d.view(), uv, stretch);
  EXPECT_EQ(m.flips, 1u);
  EXPECT_EQ(m.degenerate, 1u);
  EXPECT_TRUE(std::isinf(stretch[1]));
  EXPECT_TRUE(std::isinf(stretch[2]));
  EXPECT_NEAR(m.uv_area, 0.5 + 0.5, 1e-12);  // of the first two
}

// Triangles without area stretch nothing, whatever area they have in uv.
TEST(Distortion, TrianglesWithoutAreaDoNotStretch) {
  Disc d = bumpy(6);
  const std::vector<Vec2d> uv = flat(d);
  const auto& corner = d.triangles.back();
  d.positions[corner[2]] = d.positions[corner[1]];
  std::vector<double> stretch(d.triangles.size());
  const Distortion m = measure_distortion(d.view(), uv, stretch);
  EXPECT_EQ(stretch.back(), 1);
  EXPECT_EQ(m.degenerate, 0u);
  EXPECT_TRUE(std::isfinite(m.stretch_linf) && std::isfinite(m.conformal_max));
  std::vector<TriangleStretch> s(d.triangles.size());
  measure_triangles(d.view(), uv, s);
  EXPECT_EQ(s.back().area, 0);
  EXPECT_EQ(s.back().s1, 1);
  EXPECT_EQ(s.back().s2, 1);
}

// A scale that is given counts, whatever the areas are.
TEST(Distortion, AGivenScaleMultipliesTheSingularValues) {
  const Disc d = bumpy(10);
  const auto uv = flat(d, 0.01);
  std::vector<TriangleStretch> s(d.triangles.size());
  measure_triangles(d.view(), uv, s);
  for (const double scale : {0.4, 1.0, 3.0}) {
    double l2 = 0, area = 0, worst = 1, least = 1e300;
    for (std::size_t t = 0; t < s.size(); ++t) {
      const auto [s1, s2] = sander(d, uv, t);
      l2 += s[t].area * scale * scale * (s1 * s1 + s2 * s2) / 2;
      area += s[t].area;
      worst = std::max({worst, scale * s1, 1 / (scale * s2)});
      least = std::min(least, scale * scale * s1 * s2);
    }
    const Distortion m = summarize_distortion(s, scale);
    EXPECT_NEAR(m.stretch_l2, std::sqrt(l2 / area), 1e-5 * scale);
    EXPECT_NEAR(m.stretch_linf, worst, 1e-5 * worst) << scale;
    EXPECT_NEAR(m.area_min, least, 1e-5 * least) << scale;
  }
}

TEST(Distortion, CollapsedToALineIsInfinite) {
  // No scale fits. Some triangles keep a length, others become a point.
  std::vector<TriangleStretch> triangles(1000);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    triangles[t].area = 1 + double(t % 7);
    triangles[t].s1 = std::numeric_limits<float>::infinity();
    triangles[t].s2 = t % 3 == 0 ? triangles[t].s1 : 1;
  }
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(summarize_distortion(triangles).stretch_999, infinity);
  EXPECT_EQ(summarize_distortion(triangles).stretch_linf, infinity);
}

// What a speck of rounding noise does in uv spoils neither extremes nor means.
TEST(Distortion, NegligibleTrianglesCountOnlyForAreasAndFlips) {
  std::vector<TriangleStretch> triangles(3, {.area = 1, .uv_area = 1, .s1 = 1.25f, .s2 = 0.8f});
  const Distortion plain = summarize_distortion(triangles);
  const float infinity = std::numeric_limits<float>::infinity();
  triangles.push_back({.area = 1e-16, .uv_area = 0, .s1 = infinity, .s2 = infinity});
  triangles.push_back({.area = 1e-16, .uv_area = -1e-16, .s1 = 1e6f, .s2 = 1e-6f});
  const Distortion m = summarize_distortion(triangles);
  EXPECT_EQ(m.flips, 1u);
  EXPECT_EQ(m.degenerate, 0u);
  EXPECT_NEAR(m.stretch_l2, plain.stretch_l2, 1e-12);
  EXPECT_NEAR(m.stretch_linf, plain.stretch_linf, 1e-6);
  EXPECT_NEAR(m.stretch_999, plain.stretch_999, 1e-6);
  EXPECT_NEAR(m.conformal_mean, plain.conformal_mean, 1e-12);
  EXPECT_NEAR(m.conformal_max, plain.conformal_max, 1e-12);
  EXPECT_NEAR(m.area_min, plain.area_min, 1e-12);
  EXPECT_NEAR(m.area_max, plain.area_max, 1e-12);
}

TEST(Distortion, WithoutAreaNoScalePreservesIt) {
  EXPECT_EQ(area_preserving_scale({.surface_area = 1, .uv_area = 4}), 0.5);
  EXPECT_EQ(area_preserving_scale({.surface_area = 1, .uv_area = 0}), 0);
  EXPECT_EQ(area_preserving_scale({.surface_area = 0, .uv_area = 1}), 0);
  EXPECT_EQ(area_preserving_scale({.surface_area = 0, .uv_area = 0}), 0);
}

TEST(Distortion, PartsAddUpToTheWhole) {
  const Disc a = bumpy(12), b = testing::make_cap(1, 9);
  const auto ua = flat(a, 0.01), ub = flat(b);
  std::vector<TriangleStretch> parts(a.triangles.size() + b.triangles.size());
  const auto span = std::span(parts);
  measure_triangles(a.view(), ua, span.first(a.triangles.size()));
  measure_triangles(b.view(), ub, span.subspan(a.triangles.size()));
  Disc both = a;
  for (const Vec3d& p : b.positions) both.positions.push_back(p);
  const auto offset = static_cast<std::uint32_t>(a.positions.size());
  for (const auto& t : b.triangles)
    both.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  auto uv = ua;
  uv.insert(uv.end(), ub.begin(), ub.end());
  const Distortion whole = measure_distortion(both.view(), uv), sum = summarize_distortion(parts);
  EXPECT_EQ(whole.stretch_l2, sum.stretch_l2);
  EXPECT_EQ(whole.stretch_999, sum.stretch_999);
  EXPECT_EQ(whole.area_max, sum.area_max);
}

TEST(Distortion, DensityScalesTheSurface) {
  const Disc d = bumpy(10);
  auto uv = flat(d);
  const Distortion plain = measure_distortion(d.view(), uv);
  const std::vector<double> three(d.triangles.size(), 3.0);
  LocalMesh mesh = d.view();
  mesh.density = three;
  for (Vec2d& p : uv) p = {3 * p.x, 3 * p.y};
  const Distortion dense = measure_distortion(mesh, uv);
  EXPECT_NEAR(dense.stretch_l2, plain.stretch_l2, 1e-6);
  EXPECT_NEAR(dense.surface_area, 9 * plain.surface_area, 1e-9);
}

TEST(Distortion, KeepsDigitsOnSlivers) {
  for (const double aspect : {1e2, 1e6, 1e10, 1e12}) {
    Disc d;
    d.positions = {{0, 0, 0}, {1, 0, 0}, {0.3, 1 / aspect, 0}};
    d.triangles = {{0, 1, 2}};
    const std::vector<Vec2d> uv = {{0, 0}, {1, 0}, {0.3, 2 / aspect}};
    std::vector<TriangleStretch> s(1);
    measure_triangles(d.view(), uv, s);
    EXPECT_NEAR(s[0].s1, 1, 1e-5) << aspect;
    EXPECT_NEAR(s[0].s2, 0.5, 1e-5) << aspect;
  }
}

TEST(Distortion, DoesNotDependOnTheUnit) {
  const Disc d = bumpy(10);
  const auto uv = flat(d, 0.01);
  const Distortion plain = measure_distortion(d.view(), uv);
  for (const double scale : {1e-12, 1e-6, 1e6, 1e12}) {
    Disc scaled = d;
    testing::transform(scaled, scale);
    const Distortion m = measure_distortion(scaled.view(), uv);
    EXPECT_NEAR(m.stretch_l2, plain.stretch_l2, 1e-6);
    EXPECT_NEAR(m.stretch_999, plain.stretch_999, 1e-6);
    EXPECT_EQ(m.flips, plain.flips);
  }
}

TEST(Distortion, APartOfTheValuesHasTheirPercentile) {
  std::mt19937 random(7);
  std::exponential_distribution<double> value(1), weight(3);
  for (const double share : {0.001, 0.02, 0.6}) {
    std::vector<param::WeightedValue> all(100000);
    double total = 0;
    for (param::WeightedValue& v : all) {
      v = {std::round(100 * value(random)) / 50, weight(random)};  // with many equal values
      total += v.weight;
    }
    for (const int order : {0, 1, -1}) {  // of arrival: none, rising, falling
      std::vector<param::WeightedValue> coming = all;
      std::sort(coming.begin(), coming.end(),
                [&](const auto& a, const auto& b) { return order * a.value < order * b.value; });
      param::UpperTail tail(share * total);
      for (const param::WeightedValue& v : order == 0 ? all : coming) tail.add(v.value, v.weight);
      if (share < 0.1) {
        EXPECT_LT(tail.values().size(), all.size() / 4);
      }
      EXPECT_EQ(param::value_above_budget(tail.values(), share * total),
                param::upper_percentile(coming, share))
          << share << " " << order;
    }
  }
}

// With whole weights, the weight of larger values often is exactly the budget.
TEST(Distortion, APercentileLeavesOutAtMostTheBudget) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> value(1, 9), weight(1, 3);
  for (const std::size_t size : {1u, 2u, 5u, 40u}) {
    std::vector<param::WeightedValue> values(size);
    for (param::WeightedValue& v : values) v = {double(value(random)), double(weight(random))};
    for (int budget = 0; budget < 20; ++budget) {
      double wanted = 1e300;
      for (const param::WeightedValue& candidate : values) {
        double larger = 0;
        for (const param::WeightedValue& v : values) {
          if (v.value > candidate.value) larger += v.weight;
        }
        if (larger <= budget) wanted = std::min(wanted, candidate.value);
      }
      std::vector<param::WeightedValue> sorted = values;
      EXPECT_EQ(param::value_above_budget(sorted, budget), wanted) << size << " " << budget;
    }
  }
}

}  // namespace
}  // namespace atlas
