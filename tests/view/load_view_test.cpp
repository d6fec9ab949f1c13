// Tests load_view(): scenes from files, and what is said of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "libatlas/exporters/world.h"
#include "libatlas/image/image_io.h"
#include "libatlas/view/play.h"
#include "libatlas/view/start_camera.h"
#include "tests/view/play_folder.h"
#include "tests/view/shapes.h"

namespace atlas::testing {
namespace {

using LoadView = Folder;

TEST_F(LoadView, LoadsScenesAndSaysWhatIsWrongWithThem) {
  std::ofstream(path_ / "one.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::ofstream(path_ / "none.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_EQ(load_view(path_ / "one.obj", {}, {})->triangle_count(), 1u);
  for (const char* name : {"none.obj", "absent.obj"}) {
    const Result<ViewScene> v = load_view(path_ / name, {}, {});
    ASSERT_FALSE(v.ok());
    EXPECT_NE(v.status().message().find(name), std::string::npos);
    EXPECT_EQ(v.status().message().find('\n'), std::string::npos);
  }
}

TEST_F(LoadView, AWorldBeginsAtItsViewpoint) {
  std::ofstream(path_ / "a.wrl")
      << "#VRML V2.0 utf8\nViewpoint { position 1001 2 3 orientation 1 0 0 0.6435011087932844 }\n"
         "Shape { geometry IndexedFaceSet { coordIndex [ 0 1 2 -1 ]\n"
         "coord Coordinate { point [ 1000 0 0, 1004 0 0, 1000 4 0 ] } } }\n";
  const Result<ViewScene> view = load_view(path_ / "a.wrl", {}, {});
  ASSERT_TRUE(view.ok()) << view.status().message();
  const Camera camera = start_camera(*view, {0, 1, 0}, 75);
  EXPECT_EQ(camera.eye.x + view->origin.x, 1001);
  EXPECT_EQ(camera.eye.y + view->origin.y, 2);
  EXPECT_EQ(camera.eye.z + view->origin.z, 3);
  const double ahead = camera.eye.z - camera.target.z;
  EXPECT_GT(ahead, 0);
  EXPECT_NEAR((camera.target.y - camera.eye.y) / ahead, 0.75, 1e-9);
  EXPECT_EQ(camera.up, (Vec3d{0, 1, 0}));
  EXPECT_EQ(camera.fov_degrees, 75);
}

TEST_F(LoadView, SaysWhichMaterialsStayDark) {
  std::ofstream(path_ / "lamps.obj") << "mtllib lamps.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl "
                                        "lamp\nf 1 2 3\nusemtl screen\nf 3 2 1\n";
  std::vector<std::string> said;
  Context context;
  context.warn = [&](std::string_view line) { said.emplace_back(line); };
  std::ofstream(path_ / "lamps.mtl") << "newmtl lamp\nKe 2 2 1\nnewmtl screen\nmap_Ke film.png\n";
  const Result<ViewScene> view = load_view(path_ / "lamps.obj", {}, context);
  ASSERT_TRUE(view.ok());
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].find("1 material ('screen') emits light by a texture: it is not shown"), 0u)
      << said[0];
  ASSERT_EQ(view->emission.size(), view->positions.size());
  const auto shine = [&](const Vec3f& e) {
    return std::count(view->emission.begin(), view->emission.end(), e);
  };
  EXPECT_EQ(shine({2, 2, 1}), 3);
  EXPECT_EQ(shine({0, 0, 0}), 3);
  EXPECT_TRUE(make_view_scene(room(), {})->emission.empty()) << "memory for nothing";
  // Several are told in one line.
  std::ofstream(path_ / "lamps.mtl") << "newmtl lamp\nmap_Ke a.png\nnewmtl screen\nmap_Ke b.png\n";
  said.clear();
  ASSERT_TRUE(load_view(path_ / "lamps.obj", {}, context).ok());
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].find("2 materials ('lamp', ...) emit light by a texture"), 0u) << said[0];
}

// The codes 128 and 255 are 0.2158 and 1. Without the option they are light, as fractions.
TEST_F(LoadView, ColoursOfScansAreReflectance) {
  std::ofstream(path_ / "s.ply")
      << "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
         "float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face "
         "1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 128 128 128\n1 0 0 128 128 "
         "128\n0 1 0 255 0 0\n3 0 1 2\n";
  const ViewScene light = *load_view(path_ / "s.ply", {}, {});
  EXPECT_EQ(light.illumination.size(), 3u);
  EXPECT_EQ(light.colours[0], (Vec3f{1, 1, 1}));
  const ViewScene view = *load_view(path_ / "s.ply", {.vertices_hold_colours = true}, {});
  EXPECT_TRUE(view.illumination.empty());
  EXPECT_FALSE(view.baked());
  ASSERT_EQ(view.colours.size(), 3u);
  EXPECT_EQ(std::count(view.colours.begin(), view.colours.end(), Vec3f{1, 0, 0}), 1);
  for (const Vec3f& c : view.colours)
    EXPECT_TRUE(c.x == 1 || std::abs(c.x - 0.2158f) < 1e-3f) << c.x;
}

TEST_F(LoadView, SaysWhatIsShownOpaque) {
  std::ofstream(path_ / "p.obj") << "mtllib p.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl "
                                    "pane\nf 1 2 3\nusemtl wall\nf 3 2 1\n";
  std::vector<std::string> said;
  Context context;
  context.warn = [&](std::string_view line) { said.emplace_back(line); };
  std::ofstream(path_ / "p.mtl") << "newmtl pane\nd 0.1\nnewmtl wall\nd 1\n";
  ASSERT_TRUE(load_view(path_ / "p.obj", {}, context).ok());
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].find("1 material ('pane') is transparent: shown opaque"), 0u) << said[0];
  std::ofstream(path_ / "p.mtl") << "newmtl pane\nd 1\nnewmtl wall\nd 1\n";
  ASSERT_TRUE(load_view(path_ / "p.obj", {}, context).ok());
  EXPECT_EQ(said.size(), 1u);
}

TEST_F(LoadView, SaysWhatTheReaderLeftOut) {
  std::ofstream(path_ / "torn.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 9\n";
  std::vector<std::string> said;
  Context context;
  context.warn = [&](std::string_view line) { said.emplace_back(line); };
  ASSERT_TRUE(load_view(path_ / "torn.obj", {}, context).ok());
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].find("defect: "), 0u) << said[0];
  EXPECT_NE(said[0].find("torn.obj:5"), std::string::npos) << said[0];
}

TEST_F(LoadView, TexturesHoldLightIfTheCallerSaysSo) {
  ASSERT_TRUE(write_png(path_ / "t.png", Image8(2, 2, 3, 128), {}).ok());
  std::ofstream(path_ / "a.mtl") << "newmtl m\nmap_Kd t.png\n";
  std::ofstream(path_ / "a.obj") << "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\n"
                                    "f 1/1 2/1 3/1\n";
  for (const bool baked : {false, true})
    EXPECT_EQ(load_view(path_ / "a.obj", {.textures_hold_light = baked}, {})->baked(), baked);
}

// As those of exported .obj files do.
TEST_F(LoadView, TexturesThatNothingLightsHoldLight) {
  ASSERT_TRUE(write_png(path_ / "t.png", Image8(2, 2, 3, 128), {}).ok());
  std::ofstream(path_ / "a.obj") << "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\n"
                                    "f 1/1 2/1 3/1\n";
  for (const int model : {0, 1, 2}) {
    std::ofstream(path_ / "a.mtl") << "newmtl m\nillum " << model << "\nmap_Kd t.png\n";
    EXPECT_EQ(load_view(path_ / "a.obj", {}, {})->baked(), model == 0) << model;
    EXPECT_FALSE(load_view(path_ / "a.obj", {.textures_hold_light = false}, {})->baked());
  }
}

// Two triangles with a texture, in glTF whose second material only may be unlit.
std::string two_materials(const std::string& first, const std::string& second) {
  const std::string look = R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0}})";
  return R"({"asset":{"version":"2.0"},"extensionsUsed":["KHR_materials_unlit"],)"
         R"("buffers":[{"uri":"t.bin","byteLength":60}],)"
         R"("bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24}],)"
         R"("accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":3,)"
         R"("min":[0,0,0],"max":[1,1,0]},)"
         R"({"bufferView":1,"componentType":5126,"type":"VEC2","count":3}],)"
         R"("images":[{"uri":"t.png"}],"textures":[{"source":0}],"materials":[{)" +
         look + first + "},{" + look + second +
         R"(}],"meshes":[{"primitives":[)"
         R"({"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0},)"
         R"({"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":1}]}],)"
         R"("nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0})";
}

// The name of the extension says nothing where no material has it.
TEST_F(LoadView, MaterialsSayWhetherTheirTexturesHoldLight) {
  ASSERT_TRUE(write_png(path_ / "t.png", Image8(2, 2, 3, 128), {}).ok());
  const float values[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::ofstream(path_ / "t.bin", std::ios::binary)
      .write(reinterpret_cast<const char*>(values), sizeof values);
  const std::string light = R"(,"extensions":{"KHR_materials_unlit":{}})";
  const std::string other = R"(,"extras":{"note":"KHR_materials_unlit"})";
  const auto unlit = [&](const std::string& first, const std::string& second,
                         std::optional<bool> asked = {}) {
    std::ofstream(path_ / "a.gltf") << two_materials(first, second);
    const Result<ViewScene> view = load_view(path_ / "a.gltf", {.textures_hold_light = asked}, {});
    EXPECT_TRUE(view.ok()) << view.status().message();
    return view->unlit;
  };
  EXPECT_EQ(unlit("", other), Unlit::none);
  EXPECT_EQ(unlit("", light), Unlit::some);
  EXPECT_EQ(unlit(light, light), Unlit::all);
  EXPECT_EQ(unlit(light, light, false), Unlit::none);
  EXPECT_EQ(unlit("", other, true), Unlit::all);
}

TEST_F(LoadView, KnowsWhichWorldsAreZUp) {
  World world;
  world.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  world.uvs = {{0, 0}, {1, 0}, {0, 1}};
  world.pages.push_back({"", "", {0, 1, 2}, {0, 1, 2}});
  for (const char* name : {"a.wrl", "a.wrz", "a.obj"})
    for (const Up up : {Up::y, Up::z}) {
      world.up = up;
      AtomicFiles files;
      ASSERT_TRUE(write_world(world, path_ / name, files, {}).ok());
      ASSERT_TRUE(files.commit().ok());
      EXPECT_EQ(world_is_z_up(path_ / name), up == Up::z) << name;
    }
  EXPECT_FALSE(world_is_z_up(path_ / "absent.wrl"));
  EXPECT_FALSE(world_is_z_up(path_));
}

}  // namespace
}  // namespace atlas::testing
