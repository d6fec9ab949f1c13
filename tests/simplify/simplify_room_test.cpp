// The lit room of the shared data: LIBATLAS_DATA names the folder that contains room/scene.obj.
#include <gtest/gtest.h>

#include <cstdio>

#include "libatlas/charts/charts.h"
#include "libatlas/core/clock.h"
#include "libatlas/scene/reader.h"
#include "tests/simplify/expect_sound.h"
#include "tests/support/shared_data.h"

namespace atlas {
namespace {

using namespace simplify_test;

TEST(SimplifyRoom, WallsBecomeAHandfulAndNothingOpens) {
  const auto data = test::shared_data("room");
  if (!data) GTEST_SKIP() << test::lacks("room");
  ReadOptions read;
  read.load_textures = false;
  auto loaded = read_scene(*data / "scene.obj", read, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& scene = loaded->scene;

  ChartedMesh mesh;
  mesh.positions = scene.positions;
  mesh.indices = scene.indices;
  MeshView view = mesh.view();
  view.materials = scene.triangle_material;
  auto charts = make_charts(view, {}, {});
  ASSERT_TRUE(charts.ok()) << charts.status().message();
  mesh.charts = std::move(*charts);

  constexpr double kTexelsPerMetre = 200;
  Stopwatch watch(cpu_seconds);
  const SimplifiedMesh coarse = simplify(mesh, kTexelsPerMetre);
  const double seconds = watch.lap();
  expect_sound(mesh, coarse, kTexelsPerMetre);
  std::printf("%zu -> %zu triangles, %.2f CPU s\n", mesh.triangles(), coarse.triangle_chart.size(),
              seconds);
  EXPECT_LT(coarse.triangles_out, 60000U);

  std::vector<std::size_t> count(scene.object_names.size(), 0);
  for (const std::uint32_t t : coarse.source_triangle) ++count[scene.triangle_object[t]];
  for (std::size_t i = 0; i < count.size(); ++i) {
    const std::string& name = scene.object_names[i];
    if (name == "floor" || name == "ceil" || name.starts_with("wall")) {
      EXPECT_LE(count[i], 10U) << name;
    }
  }
}

}  // namespace
}  // namespace atlas
