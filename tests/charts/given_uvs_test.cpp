// With ChartOptions::keep_uv_charts, given charts come out as they were.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "tests/charts/given_charts.h"

namespace atlas::test {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;
constexpr float kNanUv = std::numeric_limits<float>::quiet_NaN();

double distance(double x0, double y0, double x1, double y1) {
  return std::hypot(x1 - x0, y1 - y0);
}

// Expects every edge of a kept chart to have the same multiple of its given length, and the chart
// to have the area of its surface.
void expect_similar(const Mesh& mesh, const ChartSet& set) {
  for (std::size_t k = 0; k < set.charts.size(); ++k) {
    const Chart& chart = set.charts[k];
    if (!chart.kept) continue;
    double least = 1e300, most = 0, area = 0;
    for (std::uint32_t i = 0; i < chart.triangle_count; ++i) {
      const std::uint32_t t = set.chart_triangles[chart.first_triangle + i];
      for (std::uint32_t c = 0; c < 3; ++c) {
        const std::uint32_t g = 3 * t + c, h = 3 * t + (c + 1) % 3;
        const Vec2f a = mesh.texcoords[mesh.texcoord_indices[g]],
                    b = mesh.texcoords[mesh.texcoord_indices[h]];
        const Vec2d p = set.uvs[set.triangle_uv[g]], q = set.uvs[set.triangle_uv[h]];
        if (a == b) continue;
        const double ratio = distance(p.x, p.y, q.x, q.y) / distance(a.x, a.y, b.x, b.y);
        least = std::min(least, ratio);
        most = std::max(most, ratio);
      }
      const Vec2d p = set.uvs[set.triangle_uv[3 * t]], q = set.uvs[set.triangle_uv[3 * t + 1]],
                  r = set.uvs[set.triangle_uv[3 * t + 2]];
      area += 0.5 * std::abs((q.x - p.x) * (r.y - p.y) - (r.x - p.x) * (q.y - p.y));
    }
    EXPECT_NEAR(least / most, 1, 1e-9) << "chart " << k;
    EXPECT_NEAR(area / chart.distortion.surface_area, 1, 1e-5) << "chart " << k;
  }
}

TEST(GivenUvs, OneAVertexNeedsNoIndices) {
  Mesh mesh = mapped(grid(8, 8), [](Vec3f p) { return Vec2f{p.x, 2 * p.y}; });
  const ChartSet named = keep(mesh);
  mesh.texcoord_indices.clear();
  ChartOptions options;
  options.keep_uv_charts = true;
  const Result<ChartSet> set = make_charts(mesh.view(), options, {});
  ASSERT_TRUE(set.ok()) << set.status().message();
  EXPECT_TRUE(set->charts.front().kept);
  EXPECT_EQ(bytes(*set), bytes(named));
}

// What counts is where texcoords are, not which index they have.
TEST(GivenUvs, EachCornerMayHaveATexcoordOfItsOwn) {
  Mesh mesh = halves(6, apart);
  const ChartSet shared = keep(mesh);
  std::vector<Vec2f> corners;
  for (std::uint32_t& i : mesh.texcoord_indices) {
    corners.push_back(mesh.texcoords[i]);
    i = static_cast<std::uint32_t>(corners.size()) - 1;
  }
  mesh.texcoords = corners;
  EXPECT_EQ(bytes(keep(mesh)), bytes(shared));
}

TEST(GivenUvs, OwnChartsComeBackAsTheyWere) {
  for (const Shape& shape : {torus(60, 30), icosphere(4), box(6), plate_with_holes(2, 6),
                             noisy(sphere(40, 20), 0.02, 3), cone(30, 8, 0.4)}) {
    Mesh mesh(shape);
    const ChartSet own = cut(mesh);
    wear(own, 0.05, mesh);
    const ChartSet set = keep(mesh);
    EXPECT_EQ(set.repairs.kept_charts, own.charts.size()) << shape.name;
    EXPECT_EQ(set.repairs.reflattened_charts, 0u) << shape.name;
    EXPECT_EQ(set.triangle_chart, own.triangle_chart) << shape.name;
    EXPECT_NEAR(set.distortion.stretch_l2, own.distortion.stretch_l2, 1e-4) << shape.name;
    EXPECT_NEAR(set.seam_length, own.seam_length, 1e-9 * (1 + own.seam_length)) << shape.name;
    expect_similar(mesh, set);
  }
}

TEST(GivenUvs, StretchIsKeptAndMeasured) {
  const Mesh mesh = mapped(grid(6, 6), [](Vec3f p) { return Vec2f{3 * p.x, p.y}; });
  const ChartSet set = keep(mesh);
  ASSERT_EQ(set.charts.size(), 1u);
  EXPECT_TRUE(set.charts[0].kept);
  EXPECT_NEAR(set.charts[0].distortion.stretch_999, std::sqrt(3), 1e-5);
  EXPECT_NEAR(set.charts[0].size.x, std::sqrt(3), 1e-5);
  EXPECT_NEAR(set.charts[0].size.y, 1 / std::sqrt(3), 1e-5);
}

TEST(GivenUvs, APageNeedNotBeSquare) {
  Mesh mesh(torus(40, 20));
  const ChartSet own = cut(mesh);
  wear(own, 0.05, mesh);
  for (Vec2f& uv : mesh.texcoords) uv.x /= 3;
  EXPECT_GT(keep(mesh).distortion.stretch_l2, 1.2);
  ChartOptions options;
  options.uv_aspect = 3;
  const ChartSet set = keep(mesh, options);
  EXPECT_EQ(set.repairs.kept_charts, own.charts.size());
  EXPECT_NEAR(set.distortion.stretch_l2, own.distortion.stretch_l2, 1e-4);
  options.uv_aspect = 0;
  EXPECT_EQ(make_charts(mesh.view(), options, {}).status().code(), ErrorCode::bad_option);
}

TEST(GivenUvs, MirroredAndTiledChartsGetPlacesOfTheirOwn) {
  const Mesh mesh = halves(6, [](Vec3f p, int half) {
    return Vec2f{half ? 0.3f - 0.25f * p.x : 0.25f * p.x, p.y};
  });
  const ChartSet set = keep(mesh);
  EXPECT_EQ(set.repairs.kept_charts, 2u);
  expect_similar(mesh, set);
}

TEST(GivenUvs, MirroredHalvesThatShareTheirMiddleComeApartThere) {
  const Mesh mesh = mapped(grid(6, 6), [](Vec3f p) {
    return Vec2f{p.x <= 0.5f ? p.x : 1 - p.x, p.y};
  });
  const ChartSet set = keep(mesh);
  EXPECT_EQ(set.repairs.kept_charts, 2u);
  EXPECT_EQ(set.repairs.reflattened_charts, 0u);
  EXPECT_EQ(set.charts.size(), 2u);
  EXPECT_NEAR(set.seam_length, 1, 1e-6);
  expect_similar(mesh, set);
}

TEST(GivenUvs, IslandsThatShareAVertexAreTwoCharts) {
  Mesh mesh = mapped(together(grid(3, 3), moved(grid(3, 3), 1, {1, 1, 0})), [](Vec3f p) {
    return Vec2f{p.x, p.y};
  });
  // The corner (1, 1) of both is the same texcoord.
  std::uint32_t shared = kNone;
  for (std::uint32_t& i : mesh.texcoord_indices) {
    if (!(mesh.texcoords[i] == Vec2f{1, 1})) continue;
    if (shared == kNone) shared = i;
    i = shared;
  }
  const ChartSet set = keep(mesh);
  EXPECT_EQ(set.charts.size(), 2u);
  EXPECT_EQ(set.repairs.kept_charts, 2u);
  expect_similar(mesh, set);
}

TEST(GivenUvs, TrianglesWithoutAreaCostNothing) {
  Mesh mesh = halves(6, apart);
  // One point used twice; three points on a line.
  for (const std::uint32_t v : {0u, 0u, 1u, 0u, 1u, 2u}) {
    mesh.indices.push_back(v);
    mesh.texcoord_indices.push_back(v);
  }
  const ChartSet set = keep(mesh);
  EXPECT_EQ(set.repairs.degenerate_triangles, 2u);
  EXPECT_EQ(set.repairs.kept_charts, 2u);
  EXPECT_EQ(set.charts.size(), 2u);
}

TEST(GivenUvs, WithoutUsableUvsTheMeshIsCutAsUsual) {
  const Shape shape = together(icosphere(3), moved(torus(30, 16), 1, {4, 0, 0}));
  const std::string usual = bytes(cut(Mesh(shape)));
  Mesh none(shape);
  Mesh zero = mapped(shape, [](Vec3f) { return Vec2f{0, 0}; });
  Mesh nan = mapped(shape, [](Vec3f) { return Vec2f{kNanUv, kNanUv}; });
  Mesh loose = nan, missing = nan, beyond = nan;
  loose.texcoords.assign(shape.indices.size(), {kNanUv, 0});  // one per corner
  for (std::uint32_t i = 0; i < loose.texcoord_indices.size(); ++i) loose.texcoord_indices[i] = i;
  missing.texcoord_indices.assign(shape.indices.size(), kNone);
  beyond.texcoords.clear();
  for (const Mesh* mesh : {&none, &zero, &nan, &loose, &missing, &beyond}) {
    const ChartSet set = keep(*mesh);
    EXPECT_EQ(set.repairs.kept_charts, 0u);
    EXPECT_EQ(set.repairs.reflattened_charts, 2u);
    EXPECT_EQ(bytes(set), usual);
  }
}

TEST(GivenUvs, AnyUnitOfUvsWillDo) {
  const std::string usual = bytes(keep(halves(6, apart)));
  for (const int power : {-100, -20, 20, 100}) {
    const ChartSet set = keep(halves(6, [&](Vec3f p, int half) {
      const Vec2f uv = apart(p, half);
      return Vec2f{std::ldexp(uv.x, power), std::ldexp(uv.y, power)};
    }));
    EXPECT_EQ(set.repairs.kept_charts, 2u);
    EXPECT_EQ(bytes(set), usual) << "2^" << power;
  }
}

TEST(GivenUvs, SheetsAroundOneEdgeAreKeptApart) {
  Mesh mesh(sheets(7));
  mesh.texcoords = {{-0.5f, 0},
                    // Of the edge that all sheets share; every second sheet is mirrored.
                    {0.5f, 0}};
  for (int i = 0; i < 7; ++i) mesh.texcoords.push_back({0, i % 2 ? 1.0f : -1.0f});
  mesh.texcoord_indices = mesh.indices;
  const ChartSet set = keep(mesh);
  EXPECT_EQ(set.repairs.nonmanifold_edges, 1u);
  EXPECT_EQ(set.repairs.kept_charts, 4u) << "the flattest pairs continue each other";
  EXPECT_EQ(set.charts.size(), 4u);
  expect_similar(mesh, set);
}

TEST(GivenUvs, MixedOrientationIsTurnedBeforeJudging) {
  Mesh mesh = halves(6, apart);
  for (std::size_t t = 0; t < mesh.indices.size() / 3; t += 3) {
    std::swap(mesh.indices[3 * t + 1], mesh.indices[3 * t + 2]);
    std::swap(mesh.texcoord_indices[3 * t + 1], mesh.texcoord_indices[3 * t + 2]);
  }
  const ChartSet set = keep(mesh);
  EXPECT_EQ(set.repairs.kept_charts, 2u);
  EXPECT_GT(set.flipped_triangles.size(), 0u);
}

TEST(GivenUvs, RandomUvsAreSurvived) {
  for (const Shape& shape : {soup(200, 4), icosphere(2), torus(20, 10)}) {
    const Mesh mesh = mapped(noisy(shape, 0.01, 8), [](Vec3f p) {
      return Vec2f{std::fmod(p.x * 9173.1f, 1.0f), std::fmod(p.y * 7919.7f, 1.0f)};
    });
    const ChartSet set = keep(mesh);
    EXPECT_GT(set.charts.size(), 0u) << shape.name;
    EXPECT_EQ(set.distortion.flips, 0u) << shape.name;
    expect_similar(mesh, set);
  }
}

TEST(GivenUvs, TheConeStaysAHardLimit) {
  Mesh mesh(cylinder(48, 12));
  const ChartSet own = cut(mesh);
  wear(own, 1, mesh);
  ChartOptions options;
  options.cone_degrees = 30;
  const ChartSet set = keep(mesh, options);
  EXPECT_GT(set.repairs.reflattened_charts, 0u);
  EXPECT_LE(check_charts(mesh.view(), set).cone_degrees, 30 + 1e-4);
}

// Two walls of a roof, in one chart. Its cone is half the angle between them.
TEST(GivenUvs, ChartsBeyondTheConeAreCutHoweverLittle) {
  Mesh mesh = mapped(grid(2, 2), [](Vec3f p) { return Vec2f{p.x, p.y}; });
  const double half = 29.5 * M_PI / 180;
  for (Vec3f& p : mesh.positions) {
    p = {float(std::cos(half) * p.x), p.y, float(std::sin(half) * std::min(p.x, 1 - p.x))};
  }
  ChartOptions options;
  for (const double cone : {29.0, 29.49, 29.51, 30.0}) {
    options.cone_degrees = cone;
    const ChartSet set = keep(mesh, options);
    EXPECT_EQ(set.charts.size(), cone < 29.5 ? 2u : 1u) << cone;
    EXPECT_EQ(set.repairs.kept_charts, cone < 29.5 ? 0u : 1u) << cone;
    EXPECT_LE(check_charts(mesh.view(), set).cone_degrees, cone + 1e-4);
  }
}

TEST(GivenUvs, DensityScalesKeptCharts) {
  const Mesh mesh = halves(6, apart);
  std::vector<float> density(mesh.indices.size() / 3);
  for (std::size_t t = 0; t < density.size(); ++t) density[t] = int(t / 2) % 6 >= 3 ? 4 : 1;
  MeshView view = mesh.view();
  view.density = density;
  ChartOptions options;
  options.keep_uv_charts = true;
  const Result<ChartSet> set = make_charts(view, options, {});
  ASSERT_TRUE(set.ok());
  ASSERT_EQ(set->charts.size(), 2u);
  EXPECT_NEAR(set->charts[0].size.x, 1, 1e-5);
  EXPECT_NEAR(set->charts[1].size.x, 4, 1e-4);
  EXPECT_NEAR(set->distortion.stretch_l2, 1, 1e-5);
}

// The right half lies on a page that is twice as wide, at uvs that continue the left half's.
TEST(GivenUvs, PagesOfDifferentShapesAreSeamsWhereMaterialsAreNot) {
  Mesh mesh = mapped(grid(8, 8), [](Vec3f p) {
    return Vec2f{p.x < 0.5f ? p.x : 0.25f + 0.5f * p.x, p.y};
  });
  for (std::uint32_t t = 0; t < mesh.indices.size() / 3; ++t)
    mesh.materials.push_back(t / 2 % 8 / 4);
  ChartOptions options;
  options.split_at_materials = false;
  options.material_uv_aspects = {1, 2};
  const ChartSet apart = keep(mesh, options);
  EXPECT_EQ(apart.repairs.kept_charts, 2u);
  EXPECT_NEAR(apart.distortion.stretch_999, 1, 1e-5);
  EXPECT_NEAR(apart.seam_length, 1, 1e-5);
  options.material_uv_aspects = {1, 1};
  const ChartSet together = keep(mesh, options);
  EXPECT_EQ(together.repairs.kept_charts, 1u);
  EXPECT_GT(together.distortion.stretch_999, 1.3);
  // Materials beyond the list have uv_aspect.
  options.material_uv_aspects = {2};
  options.uv_aspect = 2;
  EXPECT_EQ(keep(mesh, options).charts.size(), 1u);
  options.uv_aspect = 1;
  EXPECT_EQ(keep(mesh, options).charts.size(), 2u);
}

TEST(GivenUvs, SameBytesForAnyThreadCount) {
  Mesh mesh(together(torus(60, 30), moved(sphere(20, 10), 0.4, {3, 0, 0})));
  const ChartSet own = cut(mesh);
  wear(own, 1, mesh);
  for (std::size_t i = 0; i < mesh.texcoords.size(); i += 97) mesh.texcoords[i] = {kNanUv, 0};
  const std::string one = bytes(keep(mesh, {}, 1));
  EXPECT_EQ(one, bytes(keep(mesh, {}, 2)));
  EXPECT_EQ(one, bytes(keep(mesh, {}, 8)));
}

TEST(GivenUvs, TooFewIndicesAreAnError) {
  Mesh mesh = halves(2, apart);
  mesh.texcoord_indices.pop_back();
  ChartOptions options;
  options.keep_uv_charts = true;
  EXPECT_EQ(make_charts(mesh.view(), options, {}).status().code(), ErrorCode::bad_input);
}

TEST(GivenUvs, TooFewTexcoordsAreAnError) {
  Mesh mesh(grid(4, 4));
  mesh.texcoords.resize(mesh.positions.size() - 1);
  ChartOptions options;
  options.keep_uv_charts = true;
  EXPECT_EQ(make_charts(mesh.view(), options, {}).status().code(), ErrorCode::bad_input);
}

}  // namespace
}  // namespace atlas::test
