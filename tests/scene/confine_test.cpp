// Scenes of strangers: files outside of the scene's folder, and small files that stand for much.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/core/clock.h"
#include "libatlas/scene/reader.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/slowness.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

namespace fs = std::filesystem;
using test::Gltf;
using test::json;
using test::TempFolder;

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";

std::string ply(const std::string& texture) {
  return "ply\nformat ascii 1.0\ncomment TextureFile " + texture +
         "\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
         "property float s\nproperty float t\nelement face 1\n"
         "property list uchar int vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n"
         "3 0 1 2\n";
}

std::string wrl(const std::string& urls) {
  return "#VRML V2.0 utf8\nShape { appearance Appearance { texture ImageTexture { url " + urls +
         " } } geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0 1 0 0 0 1 0 ] } "
         "coordIndex [ 0 1 2 -1 ] } }\n";
}

// A triangle whose texture is `image`, and whose data are in the file `buffer`, 84 bytes, or in the
// JSON if that is empty.
std::string gltf(const std::string& image, const std::string& buffer) {
  Gltf g;
  g.single({{"attributes",
             {{"POSITION", g.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3)},
              {"TEXCOORD_0", g.floats({0, 0, 1, 0, 0, 1}, "VEC2", 2)}}},
            {"material", 0}});
  if (!image.empty()) {
    g.j["images"] = {{{"uri", image}}};
    g.j["textures"] = {{{"source", 0}}};
  }
  g.j["materials"] = {{{"pbrMetallicRoughness", json::object()}}};
  if (!image.empty())
    g.j["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  g.j["buffers"] = {{{"byteLength", g.bytes.size()}}};
  g.j["buffers"][0]["uri"] =
      buffer.empty() ? "data:application/octet-stream;base64," + std::string(80, 'A') : buffer;
  return g.j.dump();
}

// A folder `scene` beside a folder `secret`, which holds whatever files name.
class Confined : public ::testing::Test {
 protected:
  Confined() {
    for (const char* name : {"scene", "scene/below", "secret"})
      fs::create_directory(folder_ / name);
    for (const char* name :
         {"secret/s.png", "secret/s.mtl", "scene/in.png", "scene/in.mtl", "scene/below/in.png"})
      folder_.write(name, "newmtl a\nKd 1 1 1\n");
    for (const char* name : {"secret/s.bin", "scene/in.bin"})
      folder_.write(name, std::string(60, '\0'));
    for (const char* ending : {"png", "mtl", "bin"}) {
      fs::create_symlink(fmt::format("../secret/s.{}", ending),
                         folder_ / fmt::format("scene/link.{}", ending));
      fs::create_symlink(fmt::format("in.{}", ending),
                         folder_ / fmt::format("scene/inner.{}", ending));
    }
    fs::create_directory_symlink("../secret", folder_ / "scene/way");
  }

  Result<LoadedScene> read(const std::string& name, const std::string& bytes, bool confine) {
    return read_scene(folder_.write("scene/" + name, bytes), {.confine = confine}, {});
  }

  // All formats with a reference to NAME.png, and those with other files to NAME.mtl and NAME.bin.
  std::vector<std::pair<std::string, std::string>> naming(const std::string& name) {
    folder_.write("scene/own.mtl", "newmtl a\nmap_Kd " + name + ".png\n");
    return {{"a.obj", "mtllib own.mtl\nusemtl a\n" + kTriangle + "f 1/1 2/2 3/3\n"},
            {"b.obj", "mtllib " + name + ".mtl\nusemtl a\n" + kTriangle + "f 1 2 3\n"},
            {"a.ply", ply(name + ".png")},
            {"a.wrl", wrl("\"" + name + ".png\"")},
            {"a.gltf", gltf(name + ".png", "")},
            {"b.gltf", gltf("", name + ".bin")}};
  }

  TempFolder folder_;
};

TEST_F(Confined, FilesOutsideAreRefusedInAllFormats) {
  for (const std::string& outside :
       {std::string("../secret/s"), (folder_ / "secret/s").string(), std::string("link"),
        std::string("way/s"), std::string("below/../../secret/s")}) {
    for (const auto& [name, bytes] : naming(outside)) {
      EXPECT_TRUE(read(name, bytes, false).ok()) << name << " " << outside;
      const auto refused = read(name, bytes, true);
      EXPECT_EQ(refused.status().code(), ErrorCode::bad_input) << name << " " << outside;
      EXPECT_NE(refused.status().message().find("lies outside of the scene's folder"),
                std::string::npos)
          << refused.status().message();
      EXPECT_NE(refused.status().message().find(outside), std::string::npos)
          << refused.status().message();
    }
  }
}

TEST_F(Confined, FilesInsideAreRead) {
  for (const std::string& inside :
       {std::string("in"), std::string("inner"), std::string("./below/../in"),
        std::string("../scene/in"), (folder_ / "scene/in").string()})
    for (const auto& [name, bytes] : naming(inside))
      EXPECT_TRUE(read(name, bytes, true).ok())
          << name << " " << inside << ": " << read(name, bytes, true).status().message();
  EXPECT_TRUE(read("a.ply", ply("below/in.png"), true).ok());
  EXPECT_TRUE(read("a.ply", ply("missing.png"), true).ok());
}

// Backslashes separate folders in OBJ and MTL, and uris may be encoded.
TEST_F(Confined, OtherSpellingsAreNoWayOut) {
  folder_.write("scene/own.mtl", "newmtl a\nmap_Kd ..\\secret\\s.png\n");
  const std::string obj = "mtllib own.mtl\nusemtl a\n" + kTriangle + "f 1/1 2/2 3/3\n";
  EXPECT_FALSE(read("a.obj", obj, true).ok());
  EXPECT_FALSE(read("a.obj", "mtllib ..\\secret\\s.mtl\n" + obj, true).ok());
  EXPECT_FALSE(read("a.gltf", gltf("%2e%2e/secret/s.png", ""), true).ok());
  EXPECT_FALSE(read("a.wrl", wrl("\"%2e%2e/secret/s.png\""), true).ok());
}

// Paths of another machine do no harm if the file is beside the one that names it.
TEST_F(Confined, FilesBesideAreFoundInstead) {
  folder_.write("scene/own.mtl", "newmtl a\nmap_Kd /home/somebody/in.png\n");
  EXPECT_TRUE(read("a.obj",
                   "mtllib /home/somebody/own.mtl\nusemtl a\n" + kTriangle + "f 1/1 2/2 3/3\n",
                   true)
                  .ok());
  const auto other = read("a.wrl", wrl("[ \"../secret/s.png\" \"in.png\" ]"), true);
  EXPECT_TRUE(other.ok()) << other.status().message();
}

// What would not be read is no reason.
TEST_F(Confined, OnlyWhatIsReadCounts) {
  for (const char* name : {"a.obj", "a.ply", "a.wrl", "a.gltf"})
    for (const auto& [file, bytes] : naming("../secret/s"))
      if (file == name) {
        const auto path = folder_.write("scene/" + file, bytes);
        EXPECT_TRUE(read_scene(path, {.load_textures = false, .confine = true}, {}).ok()) << file;
      }
}

// The illumination file is the user's choice, but not what it names.
TEST_F(Confined, IlluminationHasAFolderOfItsOwn) {
  const std::string mesh = kTriangle + "f 1 2 3\n";
  const auto light = [&](const std::string& first) {
    ReadOptions options{.confine = true};
    options.illumination_file =
        folder_.write("secret/light.obj", first + "v 0 0 0 1 1 1\nv 1 0 0 1 1 1\nv 0 1 0 1 1 1\n");
    return read_scene(folder_.write("scene/m.obj", mesh), options, {}).ok();
  };
  EXPECT_TRUE(light("mtllib s.mtl\n"));
  EXPECT_FALSE(light("mtllib ../scene/in.mtl\n"));
}

// The names of images are decoded only where a lightmap is asked for.
TEST_F(Confined, LightmapsAreRefusedToo) {
  json file = json::parse(gltf("", ""));
  file["asset"]["extras"]["lightmap"] = {{"images", {"../secret/s.png"}}, {"texCoord", 0}};
  const auto path = folder_.write("scene/a.gltf", file.dump());
  EXPECT_TRUE(read_scene(path, {.confine = true}, {}).ok());
  EXPECT_TRUE(read_scene(path, {.lightmap = true}, {}).ok());
  EXPECT_FALSE(read_scene(path, {.lightmap = true, .confine = true}, {}).ok());
}

// Of a megabyte and a half that unpacks to a gigabyte and a half, ten megabytes and ten.
TEST(Limits, PackedTextIsLimitedInProportionToItsFile) {
  const TempFolder folder;
  const auto packed = [&](std::size_t blanks) {
    const fs::path path = folder / "a.wrz";
    const gzFile file = gzopen(path.c_str(), "wb");
    const std::string world =
        "#VRML V2.0 utf8\nShape { geometry IndexedFaceSet { coord Coordinate "
        "{ point [ 0 0 0 1 0 0 0 1 0 ] } coordIndex [ 0 1 2 -1 ] } }\n";
    gzwrite(file, world.data(), unsigned(world.size()));
    const std::string piece(1 << 20, ' ');
    for (std::size_t i = 0; i < blanks >> 20; ++i)
      gzwrite(file, piece.data(), unsigned(piece.size()));
    gzclose(file);
    return path;
  };
  EXPECT_TRUE(read_scene(packed(10 << 20), {}, {}).ok());
  const fs::path bomb = packed(100 << 20);
  ASSERT_LT(128 * fs::file_size(bomb), 100u << 20);
  const double begun = cpu_seconds();
  const auto refused = read_scene(bomb, {}, {});
  EXPECT_LT(cpu_seconds() - begun, 0.5 * test::kSlowness);
  EXPECT_EQ(refused.status().code(), ErrorCode::unsupported);
  EXPECT_NE(refused.status().message().find("a.wrz: holds 64 MiB of text or more"),
            std::string::npos)
      << refused.status().message();
  EXPECT_TRUE(read_scene(bomb, {.limits = false}, {}).ok());
}

// What no outline does: a face of two million corners over three vertices took twenty seconds.
TEST(Limits, FacesThatGoRoundAndRoundAreLeftOut) {
  const TempFolder folder;
  std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nf 1 2 3\nf";
  for (int i = 0; i < 300'000; ++i) obj += " 1 2 3";
  obj += "\nf 2 4 3\n";
  const double begun = cpu_seconds();
  const auto loaded = read_scene(folder.write("a.obj", obj), {}, {});
  EXPECT_LT(cpu_seconds() - begun, 0.3 * test::kSlowness);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.triangle_count(), 2u);
  EXPECT_EQ(loaded->defects.count(DefectKind::polygon_repeated), 1u);
}

// A few bytes of instances can ask for as many triangles as there are bytes in any memory.
TEST(Limits, WhatSmallGltfFilesShowIsLimited) {
  const TempFolder folder;
  Gltf g;
  std::vector<std::uint8_t> corners(30000, 0);
  g.single({{"attributes", {{"POSITION", g.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3)}}},
            {"indices", g.indices(corners)}});
  json children = json::array();
  for (int level = 1; level < 13; ++level)
    g.j["nodes"].push_back({{"children", {level - 1, level - 1}}});
  g.j["scenes"][0]["nodes"] = {12};
  const fs::path path = folder.write("a.glb", g.glb());
  const auto refused = read_scene(path, {}, {});
  EXPECT_EQ(refused.status().code(), ErrorCode::bad_input);
  EXPECT_NE(refused.status().message().find("ReadOptions::limits lifts the limit"),
            std::string::npos)
      << refused.status().message();
}

}  // namespace
}  // namespace atlas
