#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "libatlas/core/glm_bridge.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {
namespace {

ChartSet charts_of(const Mesh& mesh, const ChartOptions& options = {}, int threads = 1) {
  Context context;
  context.threads = threads;
  Result<ChartSet> result = make_charts(mesh.view(), options, context);
  EXPECT_TRUE(result.ok()) << result.status().message();
  return result.ok() ? std::move(*result) : ChartSet{};
}

TEST(Charts, EveryShapeOfTheZooComesOutWhole) {
  for (const Shape& shape : zoo()) {
    const Mesh mesh(shape);
    const ChartSet set = charts_of(mesh);
    const ChartFindings found = check_charts(mesh.view(), set);
    EXPECT_EQ(found.fault, "") << shape.name;
    EXPECT_LE(found.stretch_999, 1.25 * (1 + 1e-6)) << shape.name;
    EXPECT_NEAR(found.seam, set.seam_length, 1e-6 * (1 + set.seam_length)) << shape.name;
    EXPECT_NEAR(found.stretch_l2, set.distortion.stretch_l2, 1e-3) << shape.name;
    EXPECT_EQ(set.distortion.flips, 0u) << shape.name;
  }
}

TEST(Charts, TheBoundAskedForIsTheBoundMeasured) {
  const Mesh mesh(sphere(48, 24));
  std::size_t before = 0;
  for (const double bound : {1.6, 1.25, 1.1, 1.04}) {
    ChartOptions options;
    options.max_stretch = bound;
    const ChartSet set = charts_of(mesh, options);
    const ChartFindings found = check_charts(mesh.view(), set);
    EXPECT_EQ(found.fault, "");
    EXPECT_LE(found.stretch_999, bound * (1 + 1e-6));
    EXPECT_GE(set.charts.size(), before) << "a tighter bound needs as many charts or more";
    before = set.charts.size();
  }
}

TEST(Charts, TheConeIsAHardLimit) {
  for (const Shape& shape :
       {sphere(40, 20), torus(40, 20), box(6), noisy(sphere(40, 20), 0.02, 3)}) {
    for (const double cone : {10.0, 30.0, 60.0}) {
      const Mesh mesh(shape);
      ChartOptions options;
      options.cone_degrees = cone;
      const ChartSet set = charts_of(mesh, options);
      const ChartFindings found = check_charts(mesh.view(), set);
      EXPECT_EQ(found.fault, "") << shape.name;
      EXPECT_LE(found.cone_degrees, cone * (1 + 1e-6) + 1e-4) << shape.name << " cone " << cone;
    }
  }
}

TEST(Charts, AConeTakesFewCharts) {
  ChartOptions options;
  options.cone_degrees = 30;
  // Twenty caps of 29.6 degrees cover a sphere; greedy merging needs 35.
  EXPECT_LE(charts_of(Mesh(geodesic_sphere(30)), options).charts.size(), 40u);
  EXPECT_EQ(charts_of(Mesh(box(6)), options).charts.size(), 6u);
}

TEST(Charts, AFlatPlateIsOneChartHoweverFine) {
  for (const int n : {1, 7, 90}) {
    const Mesh mesh(grid(n, n, 3, 1));
    const ChartSet set = charts_of(mesh);
    ASSERT_EQ(set.charts.size(), 1u);
    EXPECT_TRUE(set.charts[0].planar_projection);
    EXPECT_NEAR(set.charts[0].size.x, 3, 1e-5);
    EXPECT_NEAR(set.charts[0].size.y, 1, 1e-5);
    EXPECT_EQ(set.seam_length, 0);
  }
}

TEST(Charts, AFlatPlateWithHolesStaysUncut) {
  const Shape full = grid(30, 30);
  Mesh mesh;
  mesh.positions = full.positions;
  for (std::size_t t = 0; t < full.triangle_count(); ++t) {
    const std::size_t quad = t / 2, x = quad % 30, y = quad / 30;
    const bool hole = (x / 6) % 2 == 1 && (y / 6) % 2 == 1;
    if (hole) continue;
    for (int c = 0; c < 3; ++c) mesh.indices.push_back(full.indices[3 * t + c]);
  }
  const ChartSet set = charts_of(mesh);
  EXPECT_EQ(check_charts(mesh.view(), set).fault, "");
  EXPECT_EQ(set.charts.size(), 1u);
  EXPECT_EQ(set.seam_length, 0);
}

TEST(Charts, WhatUnrollsIsUnrolledWithoutStretch) {
  for (const Shape& shape : {box(8), cylinder(48, 12), cone(48, 12, 0.4)}) {
    const Mesh mesh(shape);
    const ChartSet set = charts_of(mesh);
    const ChartFindings found = check_charts(mesh.view(), set);
    EXPECT_EQ(found.fault, "") << shape.name;
    EXPECT_LE(set.charts.size(), shape.name == "box" ? 3u : 1u) << shape.name;
    EXPECT_LT(found.stretch_l2, 1 + 1e-5) << shape.name;
  }
}

TEST(Charts, CurvedShapesNeedFewCharts) {
  const auto count = [](const Shape& shape) { return charts_of(Mesh(shape)).charts.size(); };
  EXPECT_LE(count(icosphere(4)), 7u);
  EXPECT_LE(count(torus(96, 48)), 12u);
  EXPECT_LE(count(plate_with_holes(2, 8)), 4u);
}

// A wavy prism as CAD programs triangulate it: both caps and the walls consist of needles in
// zigzag.
Shape needle_prism(int around, double height) {
  Shape shape;
  shape.name = "needle prism";
  for (const double z : {0.0, height}) {
    for (int i = 0; i < around; ++i) {
      const double a = 2 * M_PI * (i + 0.25) / around, r = 1 + 0.15 * std::cos(5 * a);
      shape.positions.push_back({float(r * std::cos(a)), float(r * std::sin(a)), float(z)});
    }
  }
  const auto n = std::uint32_t(around);
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    shape.indices.insert(shape.indices.end(), {a, b, c});
  };
  for (std::uint32_t i = 0, j = n - 1; i < j; ++i, --j) {
    const bool more = i + 1 < j, most = i + 1 < j - 1;
    if (more) {
      add(i, j, i + 1);
      add(n + i, n + i + 1, n + j);
    }
    if (most) {
      add(i + 1, j, j - 1);
      add(n + i + 1, n + j - 1, n + j);
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    add(i, j, n + i);
    add(j, n + j, n + i);
  }
  return shape;
}

TEST(Charts, NeedlesOfCadPartsTakeFewCharts) {
  for (const int around : {200, 800}) {
    const Mesh mesh(needle_prism(around, 3));
    const ChartSet set = charts_of(mesh);
    const ChartFindings found = check_charts(mesh.view(), set);
    EXPECT_EQ(found.fault, "") << around;
    EXPECT_LE(set.charts.size(), 4u) << around;
    EXPECT_LT(set.distortion.stretch_l2, 1.0001) << around;
  }
}

// Cells of a large mesh wrapped around thin tubes, which came out in seven times as many charts.
TEST(Charts, TubesInABundleTakeAboutAsManyAsEachAlone) {
  Shape bundle;
  std::size_t alone = 0;
  for (int i = 0; i < 30; ++i) {
    Shape tube = cylinder(4, 40, 0.1, 10);
    for (Vec3f& p : tube.positions) {
      const double along = 0.5 * p.z + 0.7 * i;
      p.x += float(std::sin(along) + 3 * i);
      p.y += float(std::cos(1.3 * along));
    }
    alone += checked_charts(Mesh(tube), 0).charts.size();
    bundle = i == 0 ? tube : together(bundle, tube);
  }
  EXPECT_LE(double(checked_charts(Mesh(bundle), 0).charts.size()), 1.3 * double(alone));
}

TEST(Charts, ScanNoiseHardlyAddsCharts) {
  const Shape smooth = icosphere(5);
  const ChartSet calm = charts_of(Mesh(smooth));
  const Mesh mesh(noisy_along_normals(smooth, 0.15));
  const ChartSet set = charts_of(mesh);
  EXPECT_EQ(check_charts(mesh.view(), set).fault, "");
  EXPECT_LE(double(set.charts.size()), 1.5 * double(calm.charts.size()));
}

TEST(Charts, ChartsOfAScanAreAsManyAsItsShapeNeedsHoweverFine) {
  std::size_t most = 0, least = 1000;
  for (const int n : {20, 45, 90}) {  // 8 to 162 thousand triangles
    const Shape smooth = geodesic_sphere(n);
    const Mesh mesh(noisy(smooth, 0.12 * std::sqrt(surface_area(smooth) / (20 * n * n)), 7));
    const ChartSet set = charts_of(mesh);
    EXPECT_EQ(check_charts(mesh.view(), set).fault, "") << n;
    most = std::max(most, set.charts.size());
    least = std::min(least, set.charts.size());
  }
  EXPECT_LE(most, least + 3);
  EXPECT_LE(most, 8u);
}

TEST(Charts, SameBytesForAnyThreadCount) {
  Shape many = torus(60, 30);
  for (int i = 1; i < 6; ++i) many = together(many, moved(sphere(20, 10), 0.4, {3.0 * i, 0, 0}));
  for (const Shape& shape : {many, noisy(icosphere(4), 0.01, 5)}) {
    const Mesh mesh(shape);
    const std::string one = bytes(charts_of(mesh, {}, 1));
    EXPECT_EQ(one, bytes(charts_of(mesh, {}, 2)));
    EXPECT_EQ(one, bytes(charts_of(mesh, {}, 8)));
  }
}

TEST(Charts, PowersOfTwoChangeNothingButTheScale) {
  const Shape shape = noisy(torus(60, 30), 0.01, 9);
  const ChartSet set = charts_of(Mesh(shape));
  for (const int power : {-20, -1, 7, 20}) {
    const double factor = std::ldexp(1.0, power);
    const ChartSet other = charts_of(Mesh(moved(shape, factor)));
    EXPECT_EQ(set.triangle_chart, other.triangle_chart);
    ASSERT_EQ(set.uvs.size(), other.uvs.size());
    for (std::size_t i = 0; i < set.uvs.size(); ++i) {
      ASSERT_EQ(set.uvs[i].x * factor, other.uvs[i].x);
      ASSERT_EQ(set.uvs[i].y * factor, other.uvs[i].y);
    }
  }
}

TEST(Charts, AnyScaleGivesAboutTheSameCharts) {
  const Shape shape = torus(80, 40);
  const ChartSet set = charts_of(Mesh(shape));
  for (const double factor : {1e-6, 0.03, 123.4, 1e6}) {
    const Mesh mesh(moved(shape, factor));
    const ChartSet other = charts_of(mesh);
    EXPECT_EQ(check_charts(mesh.view(), other).fault, "");
    EXPECT_NEAR(double(other.charts.size()), double(set.charts.size()),
                1 + 0.03 * double(set.charts.size()));
    EXPECT_NEAR(other.distortion.stretch_l2, set.distortion.stretch_l2, 0.01);
  }
}

TEST(Charts, MaterialsStayApartUnlessAllowed) {
  Mesh mesh(grid(20, 20));
  for (std::size_t t = 0; t < mesh.indices.size() / 3; ++t) {
    mesh.materials.push_back(t % 40 < 20 ? 3 : 5);
  }
  const ChartSet split = charts_of(mesh);
  EXPECT_EQ(split.charts.size(), 2u);
  for (std::size_t t = 0; t < mesh.materials.size(); ++t) {
    EXPECT_EQ(split.charts[split.triangle_chart[t]].material, mesh.materials[t]);
  }
  EXPECT_NEAR(split.seam_length, 1, 1e-5);
  ChartOptions options;
  options.split_at_materials = false;
  EXPECT_EQ(charts_of(mesh, options).charts.size(), 1u);
}

// Also if that triangle has no area and was added to the chart last.
TEST(Charts, AcrossMaterialsTellThatOfTheirFirstTriangle) {
  Mesh mesh(grid(20, 20));
  for (std::size_t t = 0; t < mesh.indices.size() / 3; ++t)
    mesh.materials.push_back(t % 40 < 20 ? 3 : 5);
  const std::uint32_t a = mesh.indices[3 * 30], b = mesh.indices[3 * 30 + 1];
  mesh.indices.insert(mesh.indices.begin(), {a, b, b});
  mesh.materials.insert(mesh.materials.begin(), 5);
  ChartOptions options;
  options.split_at_materials = false;
  const ChartSet set = charts_of(mesh, options);
  ASSERT_EQ(set.charts.size(), 1u);
  EXPECT_EQ(set.charts[0].material, 5u);
}

TEST(Charts, DensityScalesTheCharts) {
  const Shape shape = together(grid(10, 10), moved(grid(10, 10), 1, {5, 0, 0}));
  const Mesh mesh(shape);
  std::vector<float> density(shape.triangle_count(), 1);
  for (std::size_t t = density.size() / 2; t < density.size(); ++t) density[t] = 4;
  MeshView view = mesh.view();
  view.density = density;
  const Result<ChartSet> set = make_charts(view, {}, {});
  ASSERT_TRUE(set.ok());
  ASSERT_EQ(set->charts.size(), 2u);
  EXPECT_NEAR(set->charts[0].size.x, 1, 1e-5);
  EXPECT_NEAR(set->charts[1].size.x, 4, 1e-4);
}

TEST(Charts, GivenUvChartsAreKept) {
  Mesh mesh(grid(8, 8));
  for (const Vec3f& p : mesh.positions) mesh.texcoords.push_back({p.x, p.y});
  for (const Vec3f& p : mesh.positions) mesh.texcoords.push_back({p.x + 2, p.y});
  const auto apart = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::size_t t = 0; t < mesh.indices.size() / 3; ++t) {
    const bool right = (t / 2) % 8 >= 4;
    for (int c = 0; c < 3; ++c) {
      mesh.texcoord_indices.push_back(mesh.indices[3 * t + c] + (right ? apart : 0));
    }
  }
  ChartOptions options;
  options.keep_uv_charts = true;
  const ChartSet set = charts_of(mesh, options);
  EXPECT_EQ(set.charts.size(), 2u);
  EXPECT_NE(set.triangle_chart[0], set.triangle_chart[15]);
  EXPECT_EQ(check_charts(mesh.view(), set).fault, "");
}

TEST(Charts, BadInputAndOptionsAreNamed) {
  const auto code = [](const Mesh& mesh, const ChartOptions& options = {}) {
    return make_charts(mesh.view(), options, {}).status().code();
  };
  EXPECT_EQ(code(Mesh()), ErrorCode::bad_input);
  Mesh mesh(grid(2, 2));
  for (const std::size_t beyond : {mesh.positions.size(), std::size_t{1000}}) {
    mesh.indices[4] = static_cast<std::uint32_t>(beyond);
    EXPECT_EQ(code(mesh), ErrorCode::bad_input);
  }
  // What happens to those who copy the faces of an OBJ file, which count from 1.
  EXPECT_EQ(make_charts(mesh.view(), {}, {}).status().message(),
            "triangle 1: vertex index 1000 names none of the 9 positions (indices count from 0)");
  mesh = Mesh(grid(2, 2));
  mesh.positions[0].y = std::nanf("");
  EXPECT_EQ(code(mesh), ErrorCode::bad_input);
  mesh = Mesh(grid(2, 2));
  mesh.indices.pop_back();
  EXPECT_EQ(code(mesh), ErrorCode::bad_input);
  mesh = Mesh(grid(2, 2));
  for (const std::size_t wrong : {7, 9}) {
    mesh.materials.assign(wrong, 0);
    EXPECT_EQ(code(mesh), ErrorCode::bad_input) << wrong;
  }
  mesh = Mesh(grid(2, 2));
  MeshView dense = mesh.view();
  for (const std::size_t wrong : {7, 9}) {
    const std::vector<float> densities(wrong, 1.0f);
    dense.density = densities;
    EXPECT_EQ(make_charts(dense, {}, {}).status().code(), ErrorCode::bad_input) << wrong;
  }
  for (const float bad : {0.0f, -1.0f, std::nanf(""), std::numeric_limits<float>::infinity()}) {
    std::vector<float> one_bad(8, 1.0f);
    one_bad[5] = bad;
    dense.density = one_bad;
    const Status status = make_charts(dense, {}, {}).status();
    EXPECT_EQ(status.code(), ErrorCode::bad_input) << bad;
    EXPECT_NE(status.message().find("triangle 5"), std::string::npos) << status.message();
  }
  ChartOptions options;
  for (const double bound : {1.0, std::numeric_limits<double>::infinity(), std::nan("")}) {
    options.max_stretch = bound;
    EXPECT_EQ(code(Mesh(grid(2, 2)), options), ErrorCode::bad_option) << bound;
  }
  for (const double aspect : {0.9e-6, 1.1e6, std::nan("")}) {
    options = {};
    options.uv_aspect = aspect;
    EXPECT_EQ(code(Mesh(grid(2, 2)), options), ErrorCode::bad_option) << aspect;
  }
  options = {};
  options.cone_degrees = 181;
  EXPECT_EQ(code(Mesh(grid(2, 2)), options), ErrorCode::bad_option);
  for (const double crease : {-1.0, 0.0, 181.0, std::nan("")}) {
    options = {};
    options.crease_degrees = crease;
    EXPECT_EQ(code(Mesh(grid(2, 2)), options), ErrorCode::bad_option) << crease;
  }
}

TEST(Charts, CancellingEndsTheWork) {
  const std::atomic<bool> cancel{true};
  Context context;
  context.cancel = &cancel;
  const Mesh mesh(icosphere(3));
  EXPECT_EQ(make_charts(mesh.view(), {}, context).status().code(), ErrorCode::cancelled);
}

}  // namespace
}  // namespace atlas::test
