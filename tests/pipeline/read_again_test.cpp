// What exports write is read again as it was.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/pipeline/export_world.h"
#include "libatlas/scene/check_scene.h"
#include "libatlas/scene/reader.h"
#include "tests/pipeline/lit_scene.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

// Plain uvs say the shape of their page, so charts that are read again keep their shapes.
TEST(ReadAgain, ChartsOfAPageThatIsNotSquareAreReadAgain) {
  const TempFolder folder;
  const Shape shape = together(grid(9, 9, 2, 1), moved(cap(24, 12, 0.8), 1, {0, 0, 3}));
  LoadedScene scene;
  scene.scene.positions = shape.positions;
  scene.scene.indices = shape.indices;
  ASSERT_TRUE(complete_scene(scene.scene).ok());
  ExportOptions options;
  options.packing = PackPreset::fast;
  options.charts_only = true;
  for (const char* name : {"a.obj", "a.glb", "a.gltf"}) {
    options.target = folder / name;
    options.charts.keep_uv_charts = false;
    const auto first = export_world(scene, options, {}, {});
    ASSERT_TRUE(first.ok()) << first.status().message();
    const auto again = read_scene(options.target, {}, {});
    ASSERT_TRUE(again.ok()) << again.status().message();
    const PageReport& page = first->pages.at(0);
    EXPECT_NE(page.width, page.height);
    EXPECT_EQ(again->uv_aspect, double(page.width) / page.height) << name;
    options.charts.keep_uv_charts = true;
    options.charts.uv_aspect = again->uv_aspect;
    options.target = folder / "b.obj";
    const auto second = export_world(*again, options, {}, {});
    ASSERT_TRUE(second.ok()) << second.status().message();
    EXPECT_NEAR(second->distortion.stretch_l2, first->distortion.stretch_l2, 1e-5);
    options.charts.uv_aspect = 1;
  }
}

// A kept scene may have other uvs in its first set, of which the page of the new ones says nothing.
TEST(ReadAgain, ThePageOfAKeptScenesNewUvsIsThatOfTheirSet) {
  const TempFolder folder;
  const Shape shape = grid(9, 9, 2, 1);
  LoadedScene scene;
  scene.scene.positions = shape.positions;
  scene.scene.indices = shape.indices;
  ASSERT_TRUE(complete_scene(scene.scene).ok());
  ExportOptions options;
  options.packing = PackPreset::fast;
  options.charts_only = options.keep_scene = true;
  options.target = folder / "plain.glb";
  const auto first = export_world(scene, options, {}, {});
  ASSERT_TRUE(first.ok()) << first.status().message();
  const double shape_of_page = double(first->pages[0].width) / first->pages[0].height;
  EXPECT_NE(shape_of_page, 1);
  // There the new uvs are in the first set, too.
  EXPECT_EQ(read_scene(options.target, {}, {})->uv_aspect, shape_of_page);
  for (const Vec3f& p : shape.positions) scene.scene.texcoords.push_back({p.x, p.y});
  scene.scene.texcoord_indices = scene.scene.indices;
  options.target = folder / "textured.glb";
  ASSERT_TRUE(export_world(scene, options, {}, {}).ok());
  EXPECT_EQ(read_scene(options.target, {}, {})->uv_aspect, 0);
  // The same file kept once more.
  const auto again = read_scene(folder / "plain.glb", {.keep_scene = true}, {});
  options.target = folder / "twice.glb";
  ASSERT_TRUE(export_world(*again, options, {}, {}).ok());
  EXPECT_EQ(read_scene(options.target, {}, {})->uv_aspect, shape_of_page);
}

ExportReport must_export(const LoadedScene& scene, const ExportOptions& options) {
  auto report = export_world(scene, options, {}, {});
  EXPECT_TRUE(report.ok()) << report.status().message();
  return report.ok() ? std::move(*report) : ExportReport{};
}

// Exports light, reads the file again with its charts, and returns both reports.
std::pair<ExportReport, ExportReport> baked_and_kept(const LoadedScene& scene,
                                                     ExportOptions options,
                                                     std::vector<double>* aspects) {
  ExportReport baked = must_export(scene, options);
  const auto again = read_scene(options.target, {}, {});
  EXPECT_TRUE(again.ok()) << again.status().message();
  options.charts_only = options.charts.keep_uv_charts = true;
  options.charts.uv_aspect = again->uv_aspect > 0 ? again->uv_aspect : 1;
  options.charts.material_uv_aspects = again->material_uv_aspects;
  if (aspects) *aspects = again->material_uv_aspects;
  options.target.replace_filename("kept.obj");
  return {std::move(baked), must_export(*again, options)};
}

// Baked worlds say the shape of their pages, too.
TEST(ReadAgain, ChartsOfBakedPagesAreReadAgain) {
  const TempFolder folder;
  ExportOptions options;
  options.packing = PackPreset::fast;
  options.simplify = false;
  options.threshold = 0;
  options.texel_metres = 0.01;
  const LoadedScene one = lit_scene(grid(9, 9, 2, 1));
  for (const char* name : {"a.obj", "a.glb", "a.gltf", "a.wrl", "a.wrz"}) {
    options.target = folder / name;
    const auto [baked, kept] = baked_and_kept(one, options, nullptr);
    ASSERT_EQ(baked.pages.size(), 1u);
    EXPECT_NE(baked.pages[0].width, baked.pages[0].height);
    EXPECT_NEAR(kept.distortion.stretch_l2, baked.distortion.stretch_l2, 1e-3) << name;
  }
}

TEST(ReadAgain, BakedPagesMayDifferInShape) {
  const TempFolder folder;
  ExportOptions options;
  options.packing = PackPreset::fast;
  options.simplify = false;
  options.threshold = 0;
  options.atlas_size = 64;
  options.texel_metres = 0.003;
  const LoadedScene scene =
      lit_scene(together(grid(4, 4, 0.5, 0.5), moved(grid(4, 4, 0.5, 0.1), 1, {0, 0, 3})));
  for (const char* name : {"a.obj", "a.glb", "a.wrl"}) {
    options.target = folder / name;
    std::vector<double> aspects;
    const auto [baked, kept] = baked_and_kept(scene, options, &aspects);
    ASSERT_EQ(aspects.size(), baked.pages.size()) << name;
    for (std::size_t p = 0; p < aspects.size(); ++p)
      EXPECT_EQ(aspects[p], double(baked.pages[p].width) / baked.pages[p].height) << name;
    EXPECT_EQ(kept.repairs.kept_charts, kept.charts.size());
    EXPECT_NEAR(kept.distortion.stretch_999, 1, 1e-3) << name;
  }
}

// A scene whose corners lie in a line.
TEST(ReadAgain, ASceneWithoutAreaIsNamed) {
  const TempFolder folder;
  folder.write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  const auto scene = read_scene(folder / "line.obj", {}, {});
  ASSERT_TRUE(scene.ok()) << scene.status().message();
  ExportOptions options;
  options.packing = PackPreset::fast;
  options.charts_only = true;
  options.target = folder / "a.obj";
  const auto report = export_world(*scene, options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  ASSERT_EQ(report->advice.size(), 1u);
  EXPECT_NE(report->advice[0].find("no triangle has an area"), std::string::npos);
}

// The view that a scene's file begins with is that of its world.
TEST(ReadAgain, WorldsBeginWithTheViewOfTheirScene) {
  const TempFolder folder;
  LoadedScene room = lit_room(4);  // 4 x 3 x 2.5, with z up
  room.scene.origin = {1000, -200, 30};
  ExportOptions options;
  options.packing = PackPreset::fast;
  options.up = Up::z;
  options.atlas_size = 256;
  const auto view_of = [&](const char* name, const FileView& view) {
    options.target = folder / name;
    room.view = view;
    const auto report = export_world(room, options, {}, {});
    EXPECT_TRUE(report.ok()) << report.status().message();
    const auto again = read_scene(options.target, {}, {});
    EXPECT_TRUE(again.ok() && again->view);
    return again.ok() && again->view ? *again->view : FileView{};
  };
  // From inside, and from outside.
  for (const Vec3d eye : {Vec3d{1001, -198.5, 31}, Vec3d{1010, -190, 33}}) {
    const FileView read = view_of("w.wrl", {eye, {0.6, 0.8, 0}});
    EXPECT_NEAR(read.position.x, eye.x, 1e-4);
    EXPECT_NEAR(read.position.y, eye.y, 1e-4);
    EXPECT_NEAR(read.position.z, eye.z, 1e-4);
    EXPECT_NEAR(read.direction.x, 0.6, 1e-5);
    EXPECT_NEAR(read.direction.y, 0.8, 1e-5);
    EXPECT_NEAR(read.direction.z, 0, 1e-5);
    const bool walks = TempFolder::read(folder / "w.wrl").find("\"WALK\"") != std::string::npos;
    EXPECT_EQ(walks, eye.x < 1004);
  }
  // A view straight down has no heading.
  const FileView chosen = view_of("w.wrl", {{1001, -198.5, 31}, {0, 0, -1}});
  EXPECT_LT(std::abs(chosen.direction.z), 0.9);
  // glTF is in metres with y up, so the view is turned with the scene.
  const FileView turned = view_of("w.glb", {{1001, -198.5, 31}, {0.6, 0.8, 0}});
  EXPECT_NEAR(turned.direction.x, 0.6, 1e-5);
  EXPECT_NEAR(turned.direction.z, -0.8, 1e-5);
}

}  // namespace
}  // namespace atlas::test
