// Uvs on UDIM tiles, as painting programs read them: tile 1001 + n lies at (n mod 10, n / 10).
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "libatlas/pipeline/export_world.h"
#include "libatlas/scene/reader.h"
#include "tests/pipeline/lit_scene.h"
#include "tests/support/atlas_measure.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

ExportOptions tiles(const TempFolder& folder, std::uint32_t count) {
  ExportOptions options;
  options.target = folder / "world.obj";
  options.charts_only = true;
  options.larger_plain_page = false;
  options.atlas_size = 512;
  options.plain_pages = count;
  options.udim = true;
  options.packing = PackPreset::fast;
  return options;
}

// Moves uvs back to their tiles, which become pages. No triangle may reach into two tiles.
UvMesh of_tiles(UvMesh mesh) {
  std::vector<Vec2d> moved(mesh.uvs.size());
  std::uint32_t most = 0;
  for (UvMesh::Face& face : mesh.faces) {
    std::set<std::uint32_t> met;
    for (const std::uint32_t i : face.uv) {
      const double column = std::floor(mesh.uvs[i].x), row = std::floor(mesh.uvs[i].y);
      EXPECT_TRUE(column >= 0 && column <= 9 && row >= 0) << mesh.uvs[i].x << ' ' << mesh.uvs[i].y;
      met.insert(std::uint32_t(10 * row + column));
      moved[i] = {mesh.uvs[i].x - column, mesh.uvs[i].y - row};
    }
    EXPECT_EQ(met.size(), 1u);
    face.page = *met.begin();
    most = std::max(most, face.page);
  }
  mesh.uvs = std::move(moved);
  mesh.pages = most + 1;
  return mesh;
}

std::string text_of(const std::filesystem::path& path) {
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

std::size_t count_of(const std::string& text, const std::string& words) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(words, at)) != std::string::npos; ++at) ++count;
  return count;
}

TEST(Udim, PagesAreTilesOfOneMaterial) {
  const TempFolder folder;
  const ExportOptions options = tiles(folder, 12);
  const auto report = export_world(lit_scene(torus(48, 24)), options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  ASSERT_EQ(report->pages.size(), 12u);
  const auto read = read_uv_obj(options.target);
  ASSERT_TRUE(read.ok());
  const UvMesh mesh = of_tiles(*read);
  ASSERT_EQ(mesh.pages, 12u);
  const AtlasMeasures m = measure_atlas(mesh, 512, 512);
  EXPECT_EQ(m.triangles, 48u * 24 * 2);
  EXPECT_EQ(m.charts, report->charts.size());
  EXPECT_EQ(m.bleed + m.overlap + m.flipped + m.outside, 0u);
  EXPECT_GT(m.utilization, 0.5);
  EXPECT_NEAR(m.stretch_l2, report->distortion.stretch_l2, 0.01);
  const std::string obj = text_of(options.target);
  EXPECT_EQ(count_of(obj, "usemtl"), 1u);
  EXPECT_EQ(count_of(obj, "# uvs of UDIM tiles 1001 to 1012, packed for 512 x 512 texels each\n"),
            1u);
}

TEST(Udim, ASingleTileIsASquarePage) {
  const TempFolder folder;
  const ExportOptions options = tiles(folder, 1);
  const auto report = export_world(lit_scene(torus(24, 12)), options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  EXPECT_EQ(report->pages[0].width, report->pages[0].height);
  EXPECT_NE(text_of(options.target).find("# uvs of a square page"), std::string::npos);
}

TEST(Udim, AKeptSceneHasItsMaterialsOnAllTiles) {
  const TempFolder folder;
  LoadedScene scene = lit_scene(torus(48, 24));
  scene.scene.materials.resize(2);
  scene.scene.materials[0].name = "red";
  scene.scene.materials[1].name = "blue";
  for (std::size_t t = 0; t < scene.scene.triangle_count(); ++t)
    scene.scene.triangle_material[t] = t % 48 < 20;
  ExportOptions options = tiles(folder, 3);
  options.keep_scene = true;
  const auto report = export_world(scene, options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  ASSERT_EQ(report->pages.size(), 3u);
  const std::string obj = text_of(options.target);
  EXPECT_NE(obj.find("usemtl red"), std::string::npos);
  EXPECT_NE(obj.find("usemtl blue"), std::string::npos);
  UvMesh mesh = *read_uv_obj(options.target);  // its pages are the materials
  for (UvMesh::Face& face : mesh.faces) face.page = 0;
  mesh = of_tiles(mesh);
  EXPECT_EQ(mesh.pages, 3u);
  EXPECT_EQ(mesh.faces.size(), scene.scene.triangle_count());
  const AtlasMeasures m = measure_atlas(mesh, 512, 512);
  EXPECT_EQ(m.bleed + m.overlap + m.outside, 0u);
}

// What was written is kept as it is: charts in several tiles are no overlap.
TEST(Udim, TilesAreReadAgain) {
  const TempFolder folder;
  ExportOptions options = tiles(folder, 3);
  const auto report = export_world(lit_scene(torus(48, 24)), options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  const auto again = read_scene(options.target, {}, {});
  ASSERT_TRUE(again.ok());
  options.target = folder / "again.obj";
  options.charts.keep_uv_charts = true;
  const auto kept = export_world(*again, options, {}, {});
  ASSERT_TRUE(kept.ok()) << kept.status().message();
  EXPECT_EQ(kept->charts.size(), report->charts.size());
  EXPECT_EQ(kept->repairs.kept_charts, report->charts.size());
  EXPECT_EQ(kept->repairs.reflattened_charts, 0u);
  EXPECT_NEAR(kept->distortion.stretch_l2, report->distortion.stretch_l2, 1e-3);
}

TEST(Udim, IsRefusedWhereNoProgramWouldReadIt) {
  const TempFolder folder;
  const LoadedScene scene = lit_scene(torus(12, 6));
  const auto code = [&](auto change) {
    ExportOptions options = tiles(folder, 2);
    change(options);
    return export_world(scene, options, {}, {}).status().code();
  };
  EXPECT_EQ(code([](ExportOptions&) {}), ErrorCode::ok);
  EXPECT_EQ(code([](ExportOptions& o) { o.charts_only = false; }), ErrorCode::bad_option);
  EXPECT_EQ(code([](ExportOptions& o) { o.target.replace_extension(".glb"); }),
            ErrorCode::bad_option);
  EXPECT_EQ(code([](ExportOptions& o) { o.target.replace_extension(".wrl"); }),
            ErrorCode::bad_option);
  EXPECT_EQ(code([](ExportOptions& o) { o.plain_pages = 9000; }), ErrorCode::bad_option);
}

}  // namespace
}  // namespace atlas::test
