// OBJ files that keep the scene's faces, and the options for lightmaps.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "libatlas/pipeline/export_world.h"
#include "libatlas/scene/reader.h"
#include "libatlas/unwrap/unwrap.h"
#include "tests/support/atlas_measure.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

// A tube of quads with hexagonal caps, and a triangle.
std::string tube() {
  std::string text;
  for (const int z : {0, 1, 2})
    for (const char* at : {"1 0", "0.5 0.866", "-0.5 0.866", "-1 0", "-0.5 -0.866", "0.5 -0.866"})
      text += "v " + std::string(at) + " " + std::to_string(z) + "\n";
  text += "v 3 0 0\n";
  for (int ring = 0; ring < 2; ++ring)
    for (int k = 0; k < 6; ++k) {
      std::string face = "f";
      for (const int v : {k, (k + 1) % 6, (k + 1) % 6 + 6, k + 6})
        face += " " + std::to_string(6 * ring + v + 1);
      text += face + "\n";
    }
  return text + "f 6 5 4 3 2 1\nf 13 14 15 16 17 18\nf 1 19 7\n";
}

std::vector<std::size_t> face_sizes(const std::filesystem::path& path) {
  std::vector<std::size_t> sizes;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("f ")) sizes.push_back(std::size_t(std::ranges::count(line, ' ')));
  return sizes;
}

ExportOptions plain(const TempFolder& folder) {
  ExportOptions options;
  options.target = folder / "out.obj";
  options.charts_only = true;
  return options;
}

TEST(PolygonExport, KeepsTheFacesOnlyIfAsked) {
  const TempFolder folder;
  std::ofstream(folder / "in.obj") << tube();
  const auto scene = read_scene(folder / "in.obj", {.polygons = true}, {});
  ASSERT_TRUE(scene.ok()) << scene.status().message();
  ExportOptions options = plain(folder);
  options.polygons = true;
  const auto report = export_world(*scene, options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  EXPECT_EQ(report->cut_polygons, 0u);
  std::vector<std::size_t> expected(12, 4);
  expected.insert(expected.end(), {6, 6, 3});
  EXPECT_EQ(face_sizes(options.target), expected);
  // Each corner of the file has a uv, and faces cover what their triangles do.
  const auto read = read_scene(options.target, {}, {});
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read->scene.triangle_count(), scene->scene.triangle_count());
  const auto mesh = read_uv_obj(options.target);
  ASSERT_TRUE(mesh.ok());
  const AtlasMeasures m = measure_atlas(*mesh, report->pages[0].width, report->pages[0].height);
  EXPECT_EQ(m.overlap + m.flipped + m.bleed, 0u);

  const auto triangles = read_scene(folder / "in.obj", {}, {});
  options.polygons = false;
  ASSERT_TRUE(export_world(*triangles, options, {}, {}).ok());
  EXPECT_EQ(face_sizes(options.target), std::vector<std::size_t>(33, 3));
}

TEST(PolygonExport, IsRefusedWhereFilesHaveTrianglesOnly) {
  const TempFolder folder;
  std::ofstream(folder / "in.obj") << tube();
  auto scene = read_scene(folder / "in.obj", {.polygons = true}, {});
  ASSERT_TRUE(scene.ok());
  ExportOptions options = plain(folder);
  options.polygons = true;
  options.target = folder / "out.glb";
  EXPECT_EQ(export_world(*scene, options, {}, {}).status().code(), ErrorCode::bad_option);
  options.target = folder / "out.obj";
  options.keep_scene = true;
  EXPECT_EQ(export_world(*scene, options, {}, {}).status().code(), ErrorCode::bad_option);
  options.keep_scene = false;
  scene->scene.polygons.triangles[4] = 99;
  EXPECT_EQ(export_world(*scene, options, {}, {}).status().code(), ErrorCode::bad_input);
}

// The same uvs by the C++ call and by an export with the options of the same name.
TEST(LightmapOptions, AreThoseOfUnwrapping) {
  const TempFolder folder;
  std::ofstream(folder / "in.obj") << tube();
  const auto scene = read_scene(folder / "in.obj", {}, {});
  ASSERT_TRUE(scene.ok());
  for (const double texels : {0.0, 40.0}) {
    ExportOptions options = plain(folder);
    use_lightmap_options(texels, options);
    const auto report = export_world(*scene, options, {}, {});
    ASSERT_TRUE(report.ok()) << report.status().message();
    MeshView mesh;
    mesh.positions = scene->scene.positions;
    mesh.indices = scene->scene.indices;
    const auto unwrapped = unwrap_mesh(mesh, atlas::lightmap_options(texels), {});
    ASSERT_TRUE(unwrapped.ok());
    ASSERT_EQ(report->pages.size(), unwrapped->pages.size());
    EXPECT_EQ(report->pages[0].width, unwrapped->pages[0].width);
    EXPECT_EQ(report->pages[0].height, unwrapped->pages[0].height);
    const auto read = read_scene(options.target, {}, {});
    ASSERT_TRUE(read.ok());
    ASSERT_EQ(read->scene.texcoord_indices.size(), mesh.indices.size());
    for (std::size_t k = 0; k < mesh.indices.size(); ++k)
      EXPECT_EQ(read->scene.texcoords[read->scene.texcoord_indices[k]],
                unwrapped->uvs[unwrapped->indices[k]])
          << texels << ", corner " << k;
  }
}

}  // namespace
}  // namespace atlas::test
