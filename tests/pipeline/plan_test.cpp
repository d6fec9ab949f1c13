// The plan of an export against closed forms, and the errors that it finds before any work.
#include "libatlas/pipeline/plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "libatlas/files/atomic_file.h"
#include "libatlas/pipeline/export_world.h"
#include "tests/pipeline/lit_scene.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

LoadedScene lit_square(double side) {
  LoadedScene loaded = lit_scene(grid(1, 1, side, side));
  loaded.scene.metres_per_unit = 1;
  return loaded;
}

std::string reason_of(const ExportPlan& plan, const std::string& stage) {
  const auto step = std::find_if(plan.steps.begin(), plan.steps.end(),
                                 [&](const PlanStep& s) { return s.stage == stage; });
  return step == plan.steps.end() ? "" : step->reason;
}

// A projection along the axis stretches a triangle by 1 / cos of its angle to the axis. From a
// right angle on, there is no bound.
TEST(Plan, ConesOfARightAngleOrMorePromiseNoBound) {
  const LoadedScene loaded = lit_square(1);
  ExportOptions options;
  options.target = "w.obj";
  const auto reason = [&](double degrees) {
    options.charts.cone_degrees = degrees;
    return reason_of(make_plan(loaded.scene, options), "charts");
  };
  EXPECT_EQ(reason(60), "normals within 60° of a chart's axis: planar stretch at most 2.000");
  for (const double degrees : {90.0, 120.0, 180.0})
    EXPECT_EQ(reason(degrees).find("stretch"), std::string::npos) << reason(degrees);
  EXPECT_EQ(reason(120), "normals within 120° of a chart's axis");
}

TEST(Plan, TexelsFillTheBudgetWithinTheirLimits) {
  ExportOptions options;
  options.target = "w.obj";
  options.atlases = 2;
  options.atlas_size = 256;
  const auto texel = [&](double side) {
    return make_plan(lit_square(side).scene, options).texel_metres;
  };
  constexpr double kTolerance = 1e-8;
  EXPECT_NEAR(texel(1), 1 / std::sqrt(2.0 * 256 * 256), kTolerance);
  EXPECT_NEAR(texel(10), 0.01, kTolerance);
  EXPECT_NEAR(texel(0.1), 0.001, kTolerance);
  EXPECT_NEAR(texel(0.04), 0.04 / 64, kTolerance) << "64 across";
  options.texel_metres = 0.02;
  EXPECT_EQ(texel(1), 0.02);
}

// The quads of the grid have two edges of a side, and a diagonal.
TEST(Plan, TexelsOfFineScansAreAQuarterOfTheDistanceOfVertices) {
  ExportOptions options;
  options.target = "w.obj";
  const auto plan = [&](int n, double side) {
    return make_plan(lit_scene(grid(n, n, side, side)).scene, options);
  };
  const double edge = (2 + std::sqrt(2.0)) / 3;
  const ExportPlan scan = plan(100, 0.1);
  EXPECT_NEAR(scan.light_spacing_m, 0.001 * edge, 1e-8);
  EXPECT_NEAR(scan.texel_metres, 0.00025 * edge, 1e-8);
  EXPECT_NEAR(plan(10, 0.1).texel_metres, 0.001, 1e-8) << "vertices 1 cm apart";
  options.atlases = 1;
  options.atlas_size = 256;
  EXPECT_NEAR(plan(400, 0.01).texel_metres, 0.01 / 256, 1e-8) << "the pages hold no more";
  LoadedScene unlit = lit_square(0.1);
  unlit.scene.illumination.clear();
  EXPECT_EQ(make_plan(unlit.scene, options).light_spacing_m, 0);
}

// Six triangles of one size. One is black, one has one light, one has one light and a texture, and
// the others have a corner of another light each.
TEST(Plan, SharesAreThoseOfTheSurface) {
  Scene scene;
  scene.materials = {{.name = "plain"}, {.name = "textured"}};
  scene.materials[1].texture = 0;
  scene.textures.push_back({"t.png", Image8(2, 2, 3)});
  scene.texcoords = {{0, 0}, {1, 0}, {0, 1}};
  const Vec3f dark{}, light{1, 1, 1}, other{1, 1, 2};
  const std::vector<std::vector<Vec3f>> lights{{dark, dark, dark},    {light, light, light},
                                               {light, light, light}, {other, light, light},
                                               {light, other, light}, {light, light, other}};
  for (std::uint32_t t = 0; t < lights.size(); ++t) {
    const float x = 2 * float(t);
    for (const Vec3f& p : {Vec3f{x, 0, 0}, Vec3f{x + 1, 0, 0}, Vec3f{x, 1, 0}}) {
      scene.indices.push_back(std::uint32_t(scene.positions.size()));
      scene.texcoord_indices.push_back(std::uint32_t(scene.positions.size() % 3));
      scene.positions.push_back(p);
    }
    for (const Vec3f& l : lights[t]) scene.illumination.push_back(l);
    scene.triangle_material.push_back(t == 2 ? 1 : 0);
  }
  ExportOptions options;
  options.target = "w.obj";
  const ExportPlan plan = make_plan(scene, options);
  EXPECT_DOUBLE_EQ(plan.unlit_share, 1.0 / 6);
  EXPECT_DOUBLE_EQ(plan.uniform_share, 1.0 / 6);
  EXPECT_EQ(reason_of(plan, "reflectance"), "1 textured triangles");
  EXPECT_TRUE(plan.runs("reflectance"));
  options.quantity = Quantity::luminance;
  EXPECT_FALSE(make_plan(scene, options).runs("reflectance"));
}

TEST(Plan, StagesThatAreNotAskedForDoNotRun) {
  const LoadedScene loaded = lit_square(1);
  ExportOptions options;
  options.target = "w.obj";
  options.atlases = 3;
  options.plain_pages = 1;
  EXPECT_TRUE(make_plan(loaded.scene, options).runs("grouping"));
  EXPECT_TRUE(make_plan(loaded.scene, options).runs("simplify"));
  EXPECT_TRUE(make_plan(loaded.scene, options).runs("error"));
  options.simplify = options.measure_error = false;
  const ExportPlan plan = make_plan(loaded.scene, options);
  EXPECT_FALSE(plan.simplify);
  EXPECT_FALSE(plan.runs("simplify"));
  EXPECT_FALSE(plan.runs("error"));
  options.simplify = options.charts_only = true;  // one page of plain uvs, however many atlases
  EXPECT_FALSE(make_plan(loaded.scene, options).simplify);
  EXPECT_FALSE(make_plan(loaded.scene, options).runs("grouping"));
  options.atlases = 1;
  options.plain_pages = 3;
  EXPECT_TRUE(make_plan(loaded.scene, options).runs("grouping"));
}

TEST(Plan, ErrorsShowBeforeAnyWork) {
  const TempFolder folder;
  ExportOptions options;
  options.target = folder / "w.obj";
  const auto check = [&](double side) {
    return check_plan(make_plan(lit_square(side).scene, options), options);
  };
  EXPECT_TRUE(check(1).ok());
  EXPECT_TRUE(check(0.001).ok());
  options.texel_metres = 1;
  EXPECT_TRUE(check(1).ok());
  EXPECT_EQ(check(0.5).code(), ErrorCode::bad_option);
  EXPECT_NE(check(0.5).message().find("1 m is more than the side of a square as large as all "
                                      "surfaces, 0.5 m"),
            std::string::npos)
      << check(0.5).message();
  EXPECT_EQ(check(0).code(), ErrorCode::bad_input);
  options.charts_only = true;  // plain uvs need no texels
  EXPECT_TRUE(check(0.5).ok());
  options.target = folder / "missing" / "w.obj";
  EXPECT_EQ(check(1).code(), ErrorCode::io);
  EXPECT_EQ(folder.count(), 0u);
}

// The longest name that the file system takes for the world leaves no room for the numbers of
// pages.
TEST(Plan, NamesOfPagesThatAreTooLongShowBeforeAnyWork) {
  const TempFolder folder;
  ExportOptions options;
  std::size_t length = 200;
  while (check_writable(folder / (std::string(length + 1, 'w') + ".obj")).ok()) ++length;
  options.target = folder / (std::string(length, 'w') + ".obj");
  const auto code = [&] {
    return check_plan(make_plan(lit_square(1).scene, options), options).code();
  };
  EXPECT_EQ(code(), ErrorCode::io);
  options.charts_only = true;
  EXPECT_EQ(code(), ErrorCode::ok);
}

TEST(Plan, ItsReportDescribesTheScene) {
  LoadedScene loaded = lit_square(2);
  loaded.scene.origin = {1, 2, 3};
  loaded.scene.metres_per_unit = 0.5;
  loaded.defects.defects.push_back({});
  ExportOptions options;
  options.target = "w.obj";
  const ExportReport report = planned_report(loaded, make_plan(loaded.scene, options), options);
  EXPECT_EQ(report.target, "w.obj");
  EXPECT_EQ(report.triangles, 2u);
  EXPECT_EQ(report.vertices, 4u);
  EXPECT_EQ(report.materials, 1u);
  EXPECT_EQ(report.objects, 1u);
  EXPECT_TRUE(report.lit);
  EXPECT_FALSE(report.carried_out);
  EXPECT_EQ(report.origin, (Vec3d{1, 2, 3}));
  EXPECT_EQ(report.metres_per_unit, 0.5);
  EXPECT_FALSE(report.defects.empty());
  EXPECT_DOUBLE_EQ(report.plan.surface_area_m2, 1);
}

TEST(Plan, GivenChartsHaveNoBound) {
  const LoadedScene room = lit_room(4);
  ExportOptions options;
  options.charts.keep_uv_charts = true;
  const ExportPlan plan = make_plan(room.scene, options);
  EXPECT_NE(plan.steps[1].reason.find("given charts keep their shape, whatever it stretches; the "
                                      "others: stretch at most 1.25"),
            std::string::npos)
      << plan.steps[1].reason;
}

TEST(Plan, NamesWhatASceneDoesNotNeed) {
  LoadedScene dark = lit_room(4);
  dark.scene.illumination.assign(dark.scene.positions.size(), Vec3f{});
  ExportOptions options;
  options.target = "w.wrl";
  const ExportPlan plan = make_plan(dark.scene, options);
  EXPECT_FALSE(plan.runs("reflectance"));  // the scene has no textures
  EXPECT_TRUE(plan.runs("baking"));
  EXPECT_DOUBLE_EQ(plan.unlit_share, 1);
  options.threshold = 0;
  EXPECT_FALSE(make_plan(dark.scene, options).runs("downsizing"));
  dark.scene.illumination.clear();
  EXPECT_FALSE(make_plan(dark.scene, options).runs("baking"));
}

// A square metre with a texture that is finer than the texel, and one without a texture.
TEST(Plan, CountsTheTexelsThatTexturesAskFor) {
  const TempFolder folder;
  LoadedScene loaded = lit_scene(grid(2, 2));
  Scene& scene = loaded.scene;
  scene.metres_per_unit = 1;
  ExportOptions options;
  options.target = folder / "world.obj";
  options.atlases = 3;
  options.atlas_size = 1024;
  options.simplify = false;
  options.texel_metres = 0.01;
  EXPECT_NEAR(make_plan(scene, options).estimated_texels, 1e4, 1);
  scene.textures.push_back({"", Image8(50, 400, 3, 77)});
  scene.materials[0].texture = 0;
  for (const Vec3f& p : scene.positions) scene.texcoords.push_back({p.x, p.y});
  scene.texcoord_indices = scene.indices;
  const ExportPlan plan = make_plan(scene, options);
  EXPECT_NEAR(plan.estimated_texels, 2e4, 2);
  const auto report = export_world(loaded, options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  EXPECT_NEAR(double(report->full_texels), plan.estimated_texels, 300);
  options.texel_metres = 0;  // 1 mm, or 1.5 times a texture of 2000 texels per metre
  scene.textures[0].image = Image8(2000, 2000, 3, 77);
  EXPECT_NEAR(make_plan(scene, options).estimated_texels, 9e6, 900);
  options.follow_textures = false;
  EXPECT_NEAR(make_plan(scene, options).estimated_texels, 1e6, 100);
}

}  // namespace
}  // namespace atlas::test
