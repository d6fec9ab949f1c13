// Reads OBJ and glTF worlds back with the library's own scene readers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "libatlas/core/clock.h"
#include "libatlas/image/image_io.h"
#include "libatlas/scene/reader.h"
#include "tests/exporters/worlds.h"
#include "tests/support/slowness.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::TempFolder;
using test::wavy_world;

struct Corner {
  Vec3d position;
  Vec2f uv;
};

std::vector<Corner> corners_of(const Scene& s) {
  std::vector<Corner> result;
  for (std::size_t k = 0; k < s.indices.size(); ++k) {
    const Vec3f& p = s.positions[s.indices[k]];
    result.push_back({{s.origin.x + p.x, s.origin.y + p.y, s.origin.z + p.z},
                      s.texcoords[s.texcoord_indices[k]]});
  }
  return result;
}

void write_images(const World& world, const TempFolder& folder) {
  for (const Page& page : world.pages) {
    Image8 image(8, 8, 3, 50);
    image.at(0, 0)[1] = 250;  // bottom left
    ASSERT_TRUE(write_png(folder / page.image, image, {}).ok());
  }
}

TEST(ObjWorld, ReadsBackExactly) {
  const TempFolder folder;
  const World world = wavy_world(30, 4);
  write_images(world, folder);
  AtomicFiles files;
  const auto written = write_obj(world, folder / "my world.obj", files, {});
  ASSERT_TRUE(written.ok()) << written.status().message();
  ASSERT_TRUE(files.commit().ok());
  const auto loaded = read_scene(folder / "my world.obj", {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_TRUE(loaded->defects.empty()) << loaded->defects.lines().front();
  const Scene& s = loaded->scene;
  EXPECT_EQ(s.textures.size(), 4u);
  EXPECT_EQ(s.positions.size(), 900u);  // the pages share them
  EXPECT_EQ(written->vertices, 900u);
  const auto corners = corners_of(s);
  std::size_t k = 0;
  for (std::size_t p = 0; p < world.pages.size(); ++p) {
    for (std::size_t c = 0; c < world.pages[p].indices.size(); ++c, ++k) {
      const Vec3f& v = world.positions[world.pages[p].indices[c]];
      ASSERT_EQ(corners[k].position, (Vec3d{v.x, v.y, v.z}));
      ASSERT_EQ(corners[k].uv, world.uvs[world.pages[p].uv_indices[c]]);
      ASSERT_EQ(s.textures[s.materials[s.triangle_material[k / 3]].texture].path.filename(),
                world.pages[p].image);
    }
  }
  EXPECT_EQ(k, corners.size());
}

TEST(GltfWorld, ReadsBackInMetresAndYUp) {
  for (const char* name : {"w.glb", "w.gltf"}) {
    const TempFolder folder;
    World world = wavy_world(30, 3);
    world.up = Up::z;
    world.metres_per_unit = 0.5;
    world.origin = {1024, 512, 2048};
    for (Page& page : world.pages) page.image_source = folder / page.image;
    write_images(world, folder);
    AtomicFiles files;
    const auto written = write_gltf(world, folder / name, files, {});
    ASSERT_TRUE(written.ok()) << written.status().message();
    ASSERT_TRUE(files.commit().ok());
    if (std::string(name) == "w.glb") {
      for (const Page& page : world.pages) std::filesystem::remove(folder / page.image);
    }
    const auto loaded = read_scene(folder / name, {}, {});
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    EXPECT_TRUE(loaded->defects.empty()) << loaded->defects.lines().front();
    const Scene& s = loaded->scene;
    ASSERT_EQ(s.textures.size(), 3u);
    EXPECT_EQ(s.textures[0].image.at(0, 0)[1], 250);
    const auto corners = corners_of(s);
    std::size_t k = 0;
    for (const Page& page : world.pages) {
      for (std::size_t c = 0; c < page.indices.size(); ++c, ++k) {
        const Vec3f& v = world.positions[page.indices[c]];
        const Vec2f& t = world.uvs[page.uv_indices[c]];
        ASSERT_NEAR(corners[k].position.x, 0.5 * (1024 + v.x), 1e-3);
        ASSERT_NEAR(corners[k].position.y, 0.5 * (2048 + v.z), 1e-3);
        ASSERT_NEAR(corners[k].position.z, -0.5 * (512 + v.y), 1e-3);
        ASSERT_NEAR(corners[k].uv.x, t.x, 1e-7);
        ASSERT_NEAR(corners[k].uv.y, t.y, 1e-7);
      }
    }
    EXPECT_EQ(k, corners.size());
  }
}

// Pages are looked up with mip levels, and never beyond their edges.
TEST(GltfWorld, PagesAreFilteredAndClamped) {
  const TempFolder folder;
  const World world = wavy_world(6, 2);
  AtomicFiles files;
  ASSERT_TRUE(write_gltf(world, folder / "w.gltf", files, {}).ok() && files.commit().ok());
  const auto json = nlohmann::json::parse(TempFolder::read(folder / "w.gltf"));
  constexpr int kLinear = 0x2601, kLinearMipmapLinear = 0x2703, kClampToEdge = 0x812f;  // OpenGL's
  ASSERT_EQ(json["textures"].size(), 2u);
  for (const auto& texture : json["textures"]) {
    const auto& sampler = json["samplers"].at(texture["sampler"].get<std::size_t>());
    EXPECT_EQ(sampler["magFilter"], kLinear);
    EXPECT_EQ(sampler["minFilter"], kLinearMipmapLinear);
    EXPECT_EQ(sampler["wrapS"], kClampToEdge);
    EXPECT_EQ(sampler["wrapT"], kClampToEdge);
  }
}

TEST(GltfWorld, AWorldWithoutLightIsLitByTheViewer) {
  for (const bool image : {false, true}) {
    const TempFolder folder;
    World world = wavy_world(6, 1);
    if (!image) world.pages[0].image.clear();
    AtomicFiles files;
    ASSERT_TRUE(write_gltf(world, folder / "w.gltf", files, {}).ok() && files.commit().ok());
    const auto json = nlohmann::json::parse(TempFolder::read(folder / "w.gltf"));
    EXPECT_EQ(json.contains("extensionsUsed"), image);
    EXPECT_EQ(json["materials"][0].contains("extensions"), image);
  }
}

// Tests what the standard requires but the readers here do not check: data begin at multiples of
// their components' size, whatever the length of an image before them, and the far plane is in
// metres.
TEST(GltfWorld, DataIsAlignedAndTheFarPlaneIsInMetres) {
  for (const double metres : {0.01, 1.0, 1000.0}) {
    const TempFolder folder;
    World world = wavy_world(9, 4);
    world.metres_per_unit = metres;
    std::set<std::size_t> rests;  // of the images' lengths, modulo 4
    for (int i = 0; i < 4; ++i) {
      Page& page = world.pages[std::size_t(i)];
      const auto path = page.image_source = folder / page.image;
      ASSERT_TRUE(write_png(path, Image8(5 + 3 * i, 7, 3, std::uint8_t(40 * i)), {}).ok());
      rests.insert(TempFolder::read(path).size() % 4);
    }
    EXPECT_GT(rests.size(), 1u);
    AtomicFiles files;
    ASSERT_TRUE(write_gltf(world, folder / "w.glb", files, {}).ok());
    ASSERT_TRUE(files.commit().ok());
    const std::string bytes = TempFolder::read(folder / "w.glb");
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, 4);
    const auto document = nlohmann::json::parse(bytes.substr(20, length));
    EXPECT_EQ(document["images"].size(), 4u);
    for (const auto& accessor : document["accessors"]) {
      const auto& view = document["bufferViews"][accessor["bufferView"].get<std::size_t>()];
      EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0u);
    }
    double farthest = 0;
    for (const Vec3f& p : world.positions) {
      const Vec3d& eye = world.viewpoint.position;
      farthest = std::max(farthest, std::hypot(p.x - eye.x, p.y - eye.y, p.z - eye.z));
    }
    const auto& lens = document["cameras"][0]["perspective"];
    EXPECT_NEAR(lens["zfar"].get<double>() / (farthest * metres), 4, 1e-6);
    EXPECT_LT(lens["znear"].get<double>(), 1e-3 * lens["zfar"].get<double>());
  }
}

TEST(VrmlWorld, ReadsBackExactly) {
  for (const char* name : {"w.wrl", "w.wrz"}) {
    const TempFolder folder;
    World world = wavy_world(30, 3);
    world.up = Up::z;
    write_images(world, folder);
    AtomicFiles files;
    ASSERT_TRUE(write_vrml(world, folder / name, files, {}).ok());
    ASSERT_TRUE(files.commit().ok());
    const auto loaded = read_scene(folder / name, {}, {});
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    EXPECT_TRUE(loaded->defects.empty()) << loaded->defects.lines().front();
    const Scene& s = loaded->scene;
    EXPECT_EQ(s.textures.size(), 3u);
    const auto corners = corners_of(s);
    std::size_t k = 0;
    for (const Page& page : world.pages) {
      for (std::size_t c = 0; c < page.indices.size(); ++c, ++k) {
        const Vec3f& v = world.positions[page.indices[c]];
        ASSERT_EQ(corners[k].position, (Vec3d{v.x, v.y, v.z}));
        ASSERT_EQ(corners[k].uv, world.uvs[page.uv_indices[c]]);
        ASSERT_EQ(s.textures[s.materials[s.triangle_material[k / 3]].texture].path.filename(),
                  page.image);
      }
    }
    EXPECT_EQ(k, corners.size());
  }
}

TEST(VrmlWorld, TransformsPolygonsAndUnknownNodes) {
  const TempFolder folder;
  const auto path = folder.write("t.wrl", R"(#VRML V2.0 utf8
DEF Sun DirectionalLight { direction 0 -1 0 on TRUE }
Script { url "javascript: { [ }" field SFBool a FALSE }
Transform { children [
    DEF S Shape { geometry IndexedFaceSet { # a quad
      coord DEF C Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] }
      coordIndex [ 0, 1, 2, 3, -1, 0, 1, 7 ] creaseAngle .5 normal Normal { vector [ 0 0 1 ] }
      texCoord TextureCoordinate { point [ 0 0 1 0 1 1 0 1 ] } } }
    Group { children Shape { geometry Box { size 1 2 3 } } } ]
  translation 10 0 0 scale 2 2 -2 rotation 0 0 1 1.5707963267948966 })");
  const auto loaded = read_scene(path, {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  // Mirrored, so the order is reversed.
  EXPECT_EQ(s.indices, (std::vector<std::uint32_t>{3, 2, 1, 3, 1, 0}));
  EXPECT_EQ(s.texcoord_indices, s.indices);
  EXPECT_NEAR(s.origin.x + s.positions[1].x, 10, 1e-6);
  EXPECT_NEAR(s.origin.y + s.positions[1].y, 2, 1e-6);
  EXPECT_EQ(loaded->defects.count(DefectKind::index_out_of_range), 1u);
  EXPECT_EQ(loaded->defects.count(DefectKind::element_ignored), 1u);
}

TEST(VrmlWorld, TexturesEndWhereTheyAreSaidTo) {
  const TempFolder folder;
  const auto path = folder.write("t.wrl", R"(#VRML V2.0 utf8
Shape { appearance Appearance { texture ImageTexture { repeatS FALSE url "a.png" repeatT TRUE } }
  geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 0 ] }
    coordIndex [ 0 1 2 -1 ] texCoord TextureCoordinate { point [ 0 0 2 0 2 2 ] } } })");
  const auto loaded = read_scene(path, {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.materials[0].wrap_u, TextureWrap::clamp);
  EXPECT_EQ(loaded->scene.materials[0].wrap_v, TextureWrap::repeat);
}

TEST(VrmlWorld, DamageIsNoticed) {
  const TempFolder folder;
  AtomicFiles files;
  ASSERT_TRUE(write_vrml(wavy_world(4, 2), folder / "w.wrl", files, {}).ok());
  ASSERT_TRUE(write_vrml(wavy_world(4, 2), folder / "w.wrz", files, {}).ok());
  ASSERT_TRUE(files.commit().ok());
  for (const char* name : {"w.wrl", "w.wrz"}) {
    const std::string good = TempFolder::read(folder / name);
    for (std::size_t length = 0; length + 2 < good.size(); length += 7) {
      const auto loaded =
          read_scene(folder.write(std::string("d") + name, good.substr(0, length)), {}, {});
      // A shortened text can only be a whole world if it ends between two top-level nodes.
      if (loaded.ok()) {
        EXPECT_EQ(good.substr(length - 3).find("\nDEF"), 2u) << length;
      }
    }
    std::mt19937 random(3);
    int survived = 0;
    for (int round = 0; round < 500; ++round) {
      std::string bytes = good;
      bytes[random() % bytes.size()] = char(random());
      const auto loaded = read_scene(folder.write(std::string("d") + name, bytes), {}, {});
      if (!loaded.ok()) continue;
      ++survived;
      for (const std::uint32_t i : loaded->scene.indices)
        ASSERT_LT(i, loaded->scene.positions.size());
    }
    // Of gzip files, hardly any damage is no error.
    EXPECT_GT(survived, name == std::string("w.wrl") ? 100 : 0) << name;
  }
  std::string deep = "#VRML V2.0 utf8\n";
  for (int i = 0; i < 100000; ++i) deep += "Group { children ";
  EXPECT_EQ(read_scene(folder.write("deep.wrl", deep), {}, {}).status().code(),
            ErrorCode::bad_input);
  EXPECT_EQ(read_scene(folder.write("old.wrl", "#VRML V1.0 ascii\n"), {}, {}).status().code(),
            ErrorCode::bad_input);
}

// Colours from one texel: 150 000 positions at one uv, which were once compared with each other.
TEST(GltfWorld, OneUvForAllTakesLittleTime) {
  const TempFolder folder;
  World world = wavy_world(387, 1);
  world.uvs = {{0.5f, 0.5f}};
  std::fill(world.pages[0].uv_indices.begin(), world.pages[0].uv_indices.end(), 0u);
  AtomicFiles files;
  const double begun = cpu_seconds();
  const auto written = write_gltf(world, folder / "w.gltf", files, {});
  EXPECT_LT(cpu_seconds() - begun, 0.5 * test::kSlowness);
  ASSERT_TRUE(written.ok()) << written.status().message();
  EXPECT_EQ(written->vertices, world.positions.size());
}

TEST(GltfWorld, FailsWithoutItsImagesOrTriangles) {
  const TempFolder folder;
  World world = wavy_world(5, 1);
  world.pages[0].image_source = folder / "gone.png";
  {
    AtomicFiles files;
    EXPECT_EQ(write_gltf(world, folder / "w.glb", files, {}).status().code(), ErrorCode::io);
    folder.write("gone.png", "");
    EXPECT_EQ(write_gltf(world, folder / "w.glb", files, {}).status().code(), ErrorCode::io);
    std::filesystem::remove(folder / "gone.png");
    world.pages.clear();
    EXPECT_EQ(write_gltf(world, folder / "w.glb", files, {}).status().code(), ErrorCode::bad_input);
  }
  EXPECT_EQ(folder.count(), 0u);
}

TEST(CheckWorld, NamesPageListAndElement) {
  const auto message = [](auto spoil) {
    World world = wavy_world(4, 2);
    spoil(world);
    return check_world(world).message();
  };
  const auto expect = [&](const char* named, auto spoil) {
    EXPECT_NE(message(spoil).find(named), std::string::npos) << message(spoil);
  };
  expect("page 1: indices[4] is 99, but there are 16",
         [](World& w) { w.pages[1].indices[4] = 99; });
  expect("page 0: uv_indices[0] is 77777", [](World& w) { w.pages[0].uv_indices[0] = 77777; });
  expect("and 0 uv_indices", [](World& w) { w.pages[0].uv_indices.clear(); });
  expect("metres_per_unit is 0", [](World& w) { w.metres_per_unit = 0; });
}

// Comments end with their line, so texts with line breaks of any system must stay on one line.
TEST(ObjWorld, CommentsStayOnTheirLines) {
  const TempFolder folder;
  World world = wavy_world(4, 1);
  world.pages[0].image.clear();
  world.title = "a title\nf 1 1 1\r\nv 0 0 nan\rmore \\";
  world.info = {"one\rtwo", "ends in \\", "three\nv 1 2"};
  AtomicFiles files;
  ASSERT_TRUE(write_obj(world, folder / "w.obj", files, {}).ok());
  ASSERT_TRUE(files.commit().ok());
  const std::string text = TempFolder::read(folder / "w.obj");
  EXPECT_EQ(text.find('\r'), std::string::npos);
  EXPECT_EQ(text.find('\\'), std::string::npos);
  const auto loaded = read_scene(folder / "w.obj", {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_TRUE(loaded->defects.empty());
  EXPECT_EQ(loaded->scene.triangle_count(), world.pages[0].indices.size() / 3);
}

}  // namespace
}  // namespace atlas
