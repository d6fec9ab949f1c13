// ChartOptions::keep_uv_charts remakes only the bad ones among the given charts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/charts/given_charts.h"

namespace atlas::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// Expects that the mesh keeps no chart, and that its only one is flattened anew. Returns that
// chart.
Chart the_chart_made_anew(const Mesh& mesh) {
  const ChartSet set = keep(mesh);
  EXPECT_EQ(set.repairs.kept_charts, 0u);
  EXPECT_EQ(set.repairs.reflattened_charts, 1u);
  EXPECT_EQ(set.charts.size(), 1u);
  return set.charts.empty() ? Chart{} : set.charts[0];
}

TEST(GivenUvs, AFlippedTriangleCostsItsChartOnly) {
  Mesh mesh(torus(60, 30));
  const ChartSet own = cut(mesh);
  wear(own, 1, mesh);
  const ChartSet before = keep(mesh);
  ASSERT_GE(own.charts.size(), 2u);
  // One corner of one triangle of the last chart moves across the opposite edge.
  const std::uint32_t t = own.chart_triangles.back(), last = own.triangle_chart[t];
  const auto uv = [&](int c) -> Vec2f& { return mesh.texcoords[mesh.texcoord_indices[3 * t + c]]; };
  uv(0) = {uv(1).x + uv(2).x - uv(0).x, uv(1).y + uv(2).y - uv(0).y};
  const ChartSet set = keep(mesh);
  EXPECT_EQ(set.repairs.kept_charts, own.charts.size() - 1);
  EXPECT_EQ(set.repairs.reflattened_charts, 1u);
  EXPECT_EQ(set.triangle_chart, before.triangle_chart) << "the bad chart flattens in its outline";
  for (std::uint32_t k = 0; k < set.charts.size(); ++k) {
    EXPECT_EQ(set.charts[k].kept, k != last);
    if (k == last) {
      EXPECT_LE(set.charts[k].distortion.stretch_999, 1.25);
      continue;
    }
    for (std::uint32_t i = set.charts[k].first_uv;
         i < set.charts[k].first_uv + set.charts[k].uv_count; ++i) {
      ASSERT_EQ(set.uvs[i], before.uvs[i]) << "not one bit";
    }
  }
}

// A single chart of a length without bounds would leave its page empty.
TEST(GivenUvs, ChartsSqueezedToALineAreFlattenedAnew) {
  for (const float squeeze : {1e-3f, 1e-4f, 1e-7f, 1e-12f}) {
    Mesh mesh = halves(8, [&](Vec3f p, int half) {
      return half == 0 ? Vec2f{squeeze * p.x, p.y} : apart(p, half);
    });
    for (Vec3f& p : mesh.positions) p = {1e4f * p.x, 1e4f * p.y, 1e4f * p.z};
    const ChartSet set = keep(mesh);
    ASSERT_EQ(set.charts.size(), 2u);
    EXPECT_EQ(set.charts[0].kept, squeeze == 1e-3f) << squeeze;
    EXPECT_TRUE(set.charts[1].kept);
    EXPECT_EQ(set.repairs.kept_charts, squeeze == 1e-3f ? 2u : 1u);
    EXPECT_EQ(set.repairs.reflattened_charts, squeeze == 1e-3f ? 0u : 1u);
    EXPECT_NEAR(set.charts[0].size.x, squeeze == 1e-3f ? 316228 : 1e4, 1);
  }
}

TEST(GivenUvs, ATexcoordFarFromItsChartCostsThatChartOnly) {
  for (const float far : {1e4f, 1e9f, 1e30f}) {
    Mesh mesh = halves(8, apart);
    mesh.texcoords[0] = {-far, -far};  // the corner of the left half
    const ChartSet set = keep(mesh);
    ASSERT_EQ(set.charts.size(), 2u);
    EXPECT_FALSE(set.charts[0].kept) << far;
    EXPECT_TRUE(set.charts[1].kept);
    EXPECT_NEAR(set.charts[0].size.x, 1, 1e-5);
  }
}

// A ring is closed in the texture only, with other vertices on one bank of its seam than on the
// other. Rounding decides whether the banks lie on each other.
TEST(GivenUvs, BordersThatTouchAreParted) {
  for (const double overlap : {0.0, 1e-9, 1e-7, 1e-6, 1e-3}) {
    Mesh mesh = mapped(grid(60, 7, 10, 1), [&](Vec3f p) {
      const double angle = 0.5 + (2 * std::numbers::pi + overlap) * p.x / 10;
      const double r = p.x == 0 ? 1 + std::pow(p.y, 1.3) : 1 + p.y;
      return Vec2f{float(-r * std::cos(angle)), float(r * std::sin(angle))};
    });
    const ChartSet set = keep(mesh);
    ASSERT_EQ(set.charts.size(), 1u);
    EXPECT_EQ(set.charts[0].kept, overlap < 1e-3) << overlap;
    if (overlap > 1e-4) continue;
    // The area between radii 1 and 2 is 3 pi, that of the surface 10.
    EXPECT_NEAR(set.charts[0].size.y, 4 * std::sqrt(10 / (3 * std::numbers::pi)), 1e-2);
    EXPECT_EQ(keep(mesh, {}, 8).uvs, set.uvs);
  }
}

// What is long on the surface, too, or was cut along a short border, is as long as it should be.
TEST(GivenUvs, LongChartsOfLongSurfacesAreKept) {
  const Mesh ribbon = mapped(grid(400, 1, 1e4, 1), [](Vec3f p) { return Vec2f{p.x, p.y}; });
  EXPECT_EQ(keep(ribbon).repairs.kept_charts, 1u);
  // Wound 50 times around, far beyond its box.
  Mesh roll(grid(2000, 1, 2000, 1));
  for (const Vec3f& p : roll.positions) roll.texcoords.push_back({p.x, p.y});
  roll.texcoord_indices = roll.indices;
  for (Vec3f& p : roll.positions) {
    const float angle = 0.157f * p.x, r = 6 + 0.001f * p.x;
    p = {r * std::cos(angle), r * std::sin(angle), p.y};
  }
  EXPECT_EQ(keep(roll).repairs.kept_charts, 1u);
  // A bowl that is nearly closed: its border is a hundredth of its diameter.
  Mesh bowl = mapped(grid(40, 40, 2, 2), [](Vec3f p) { return Vec2f{p.x, p.y}; });
  for (Vec3f& p : bowl.positions) {
    const float x = p.x - 1, y = p.y - 1, r = std::max(std::abs(x), std::abs(y));
    const float polar = 3.13f * r, round = std::hypot(x, y);
    const float side = round > 0 ? std::sin(polar) / round : 0;
    p = {side * x, side * y, std::cos(polar)};
  }
  EXPECT_EQ(keep(bowl).repairs.kept_charts, 1u);
}

TEST(GivenUvs, AFoldWithABadHalfIsFlattenedWhole) {
  for (const std::size_t column : {1, 5}) {
    Mesh mesh = mapped(grid(6, 6), [](Vec3f p) { return Vec2f{p.x <= 0.5f ? p.x : 1 - p.x, p.y}; });
    mesh.texcoords[7 + column] = {0.9f, 0.9f};  // moves an inner vertex of this half far away
    EXPECT_NEAR(the_chart_made_anew(mesh).size.y, 1, 1e-5);
  }
}

// The band goes around more than once, and then back on its other side, or the other way around.
TEST(GivenUvs, AFoldWithAHalfThatCoversItselfIsFlattenedWhole) {
  for (const bool back_first : {false, true}) {
    const Mesh mesh = mapped(grid(60, 2, 12, 0.4), [&](Vec3f p) {
      const float x = back_first ? 12 - p.x : p.x, angle = x <= 8 ? x : 16 - x, r = 1 + p.y;
      return Vec2f{-r * std::cos(angle), r * std::sin(angle)};
    });
    EXPECT_NEAR(the_chart_made_anew(mesh).size.x, 12, 1e-3);
  }
}

// One chart is folded so close to its border that it is flattened whole, the other in its middle.
TEST(GivenUvs, EachFoldedChartIsJudgedByItself) {
  for (const bool narrow_first : {true, false}) {
    const Mesh mesh = halves(60, [&](Vec3f p, int half) {
      const bool narrow = (half == 0) == narrow_first;
      const float fold = narrow ? 59.0f / 60 : 0.5f;
      return Vec2f{p.x + 2 * float(half), p.y <= fold ? p.y : 2 * fold - p.y};
    });
    const ChartSet set = keep(mesh);
    EXPECT_EQ(set.repairs.kept_charts, 2u);
    EXPECT_EQ(set.repairs.reflattened_charts, 1u);
    EXPECT_EQ(set.charts.size(), 3u);
  }
}

// The least altitude of a triangle in uvs is that of rounding.
TEST(GivenUvs, NeedlesThatRoundingMayFlipAreRepaired) {
  for (const float altitude : {1e-9f, 1e-3f}) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0.5f, 0.5f, 0}, {0.5f, 1, 0}};
    mesh.indices = {0, 1, 2, 1, 3, 2, 3, 0, 2};
    mesh.texcoords = {{0, 0}, {1, 0}, {0.5f, altitude}, {0.5f, 1}};
    mesh.texcoord_indices = mesh.indices;
    EXPECT_EQ(keep(mesh).repairs.kept_charts, altitude < 1e-7f ? 0u : 1u) << altitude;
  }
}

TEST(GivenUvs, AChartThatCoversItselfIsRepaired) {
  // All triangles are oriented correctly, but the band goes around twice.
  const Mesh mesh = mapped(grid(60, 2, 12, 0.4), [](Vec3f p) {
    const float r = 1 + p.y;
    return Vec2f{-r * std::cos(p.x), r * std::sin(p.x)};
  });
  EXPECT_NEAR(the_chart_made_anew(mesh).size.x, 12, 1e-3);
}

TEST(GivenUvs, ClosedSurfacesGetTheChartsTheyNeed) {
  const Mesh mesh = mapped(icosphere(4), [](Vec3f p) { return Vec2f{p.x, p.y}; });
  const ChartSet set = keep(mesh);
  EXPECT_EQ(set.repairs.reflattened_charts, 1u);
  EXPECT_LE(set.charts.size(), cut(mesh).charts.size());
  EXPECT_LE(set.distortion.stretch_999, 1.25);
  EXPECT_EQ(set.repairs.split_charts, 1u);
}

TEST(GivenUvs, FlatTrianglesOfRealOnesAreRepaired) {
  const Mesh mesh = halves(6, [](Vec3f p, int half) {
    return half ? Vec2f{2 + p.x, p.y} : Vec2f{p.x, p.y > 0.4f && p.y < 0.6f ? 1 / 3.0f : p.y};
  });
  const ChartSet set = keep(mesh);
  EXPECT_EQ(set.charts.size(), 2u);
  EXPECT_EQ(set.repairs.kept_charts, 1u);
  EXPECT_EQ(set.repairs.reflattened_charts, 1u);
  EXPECT_FALSE(set.charts[set.triangle_chart[0]].kept);
}

TEST(GivenUvs, AChartWithABadCornerIsRepairedInItsOutline) {
  for (const float bad : {kNan, std::numeric_limits<float>::infinity()}) {
    Mesh mesh = halves(6, apart);
    for (const Vec2f uv : {Vec2f{bad, 0.25f}, Vec2f{0.25f, bad}}) {
      mesh.texcoords[2 * 7 + 1] = uv;
      const ChartSet set = keep(mesh);
      EXPECT_EQ(set.charts.size(), 2u);
      EXPECT_EQ(set.repairs.kept_charts, 1u);
      EXPECT_EQ(set.repairs.reflattened_charts, 1u);
    }
  }
}

}  // namespace
}  // namespace atlas::test
