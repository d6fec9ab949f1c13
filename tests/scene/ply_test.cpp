#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <random>

#include "libatlas/core/srgb.h"
#include "libatlas/scene/reader.h"
#include "tests/scene/load_scene.h"
#include "tests/scene/sound.h"
#include "tests/scene/temp_folder.h"

namespace atlas {
namespace {

using test::load;
using test::TempFolder;

// Writes a PLY file in any format and with any types, one value after the other.
class Writer {
 public:
  Writer(std::string format, std::string header) : format_(std::move(format)) {
    bytes_ = "ply\nformat " + format_ + " 1.0\ncomment made by a test\n" + header + "end_header\n";
  }
  template <class T>
  Writer& put(T value) {
    if (format_ == "ascii") {
      bytes_ += fmt::format("{} ", value);
      return *this;
    }
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if (format_ == "binary_big_endian") std::reverse(raw, raw + sizeof(T));
    bytes_.append(raw, sizeof(T));
    return *this;
  }
  Writer& end() {
    if (format_ == "ascii") bytes_ += '\n';
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string format_, bytes_;
};

class PlyFormats : public ::testing::TestWithParam<const char*> {};

TEST_P(PlyFormats, ReadAlike) {
  const TempFolder folder;
  Writer w(GetParam(),
           "element camera 1\nproperty float view\nproperty list uchar float row\n"
           "element vertex 5\nproperty double x\nproperty uchar flag\nproperty float y\n"
           "property int z\nproperty float red\nproperty float green\nproperty float blue\n"
           "property float s\nproperty float t\n"
           "element face 2\nproperty short group\nproperty list ushort int vertex_indices\n"
           "element edge 1\nproperty int a\n");
  w.put(1.5f).put(std::uint8_t{2}).put(0.5f).put(0.25f).end();
  for (int i = 0; i < 5; ++i) {
    w.put(0.125 * i).put(std::uint8_t(i)).put(float(i * i)).put(std::int32_t(-i));
    w.put(1000.25f * float(i)).put(-0.5f).put(0.f).put(float(i) * 2 - 3).put(0.75f).end();
  }
  w.put(std::int16_t{-1}).put(std::uint16_t{3});
  for (const int v : {0, 1, 2}) w.put(std::int32_t(v));
  w.end().put(std::int16_t{7}).put(std::uint16_t{4});
  for (const int v : {0, 2, 3, 4}) w.put(std::int32_t(v));
  w.end().put(std::int32_t{3}).end();

  const auto loaded = read_scene(folder.write("a.ply", w.bytes()), {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  EXPECT_EQ(s.triangle_count(), 3u);
  ASSERT_EQ(s.positions.size(), 5u);
  EXPECT_EQ(s.positions[3], (Vec3f{0.375f, 9, -3}));
  EXPECT_EQ(s.illumination[3], (Vec3f{3000.75f, -0.5f, 0}));
  EXPECT_EQ(s.texcoords[4], (Vec2f{5, 0.75f}));
  EXPECT_EQ(s.texcoord_indices, s.indices);
  EXPECT_EQ(loaded->defects.count(DefectKind::element_ignored), 2u);
}

TEST_P(PlyFormats, IntegerColoursAreFractions) {
  const TempFolder folder;
  for (const bool wide : {false, true}) {
    const std::string type = wide ? "ushort" : "uchar";
    Writer w(GetParam(),
             "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
             "property " +
                 type + " red\nproperty " + type + " green\nproperty " + type +
                 " blue\nelement face 1\nproperty list uchar uint vertex_index\n");
    for (int i = 0; i < 3; ++i) {
      w.put(float(i)).put(float(i * i)).put(0.f);
      for (const int c : {0, 51, 255}) {
        wide ? w.put(std::uint16_t(c * 257)) : w.put(std::uint8_t(c));
      }
      w.end();
    }
    w.put(std::uint8_t{3}).put(0u).put(1u).put(2u).end();
    const auto loaded = read_scene(folder.write("c.ply", w.bytes()), {}, {});
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    EXPECT_EQ(loaded->scene.illumination[1], (Vec3f{0, 0.2f, 1}));
  }
}

TEST_P(PlyFormats, StripsOfTriangles) {
  const TempFolder folder;
  Writer w(GetParam(),
           "element vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
           "element tristrips 1\nproperty list int int vertex_indices\n");
  for (int i = 0; i < 5; ++i) w.put(float(i / 2)).put(float(i % 2)).put(0.f).end();
  w.put(9);
  for (const int v : {0, 1, 2, 3, -1, 2, 3, 4, 77}) w.put(v);
  w.end();
  const auto loaded = read_scene(folder.write("s.ply", w.bytes()), {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.indices, (std::vector<std::uint32_t>{0, 1, 2, 2, 1, 3, 2, 3, 4}));
  EXPECT_EQ(loaded->defects.count(DefectKind::index_out_of_range), 1u);
}

// A file that is cut anywhere gives an error, but no crash and no scene with fewer triangles.
TEST_P(PlyFormats, EveryTruncationIsNoticed) {
  const TempFolder folder;
  Writer w(GetParam(),
           "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 1\nproperty list uchar int vertex_indices\n");
  for (int i = 0; i < 3; ++i) w.put(float(i)).put(float(i * i)).put(1.f).end();
  w.put(std::uint8_t{3}).put(0).put(1).put(2).end();
  const bool ascii = std::string(GetParam()) == "ascii";
  const std::size_t needed = w.bytes().size() - (ascii ? 2 : 0);  // the last blank and line end
  for (std::size_t length = 0; length < needed; ++length) {
    const auto loaded = read_scene(folder.write("t.ply", w.bytes().substr(0, length)), {}, {});
    ASSERT_FALSE(loaded.ok()) << length;
    EXPECT_EQ(loaded.status().code(), ErrorCode::bad_input);
    EXPECT_NE(loaded.status().message().find("t.ply"), std::string::npos);
  }
}

TEST_P(PlyFormats, RandomDamageNeverCrashes) {
  const TempFolder folder;
  Writer w(
      GetParam(),
      "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
      "property uchar green\nproperty uchar blue\nelement face 2\n"
      "property list uchar int vertex_indices\nproperty list uchar float texcoord\n");
  for (int i = 0; i < 4; ++i) {
    w.put(float(i)).put(float(i * i)).put(1.f);
    for (int c = 0; c < 3; ++c) w.put(std::uint8_t(100));
    w.end();
  }
  for (int f = 0; f < 2; ++f) {
    w.put(std::uint8_t{3}).put(0).put(1 + f).put(2 + f).put(std::uint8_t{6});
    for (int k = 0; k < 6; ++k) w.put(0.5f);
    w.end();
  }
  std::mt19937 random(5);
  int survived = 0;
  for (int round = 0; round < 1500; ++round) {
    std::string bytes = w.bytes();
    for (int hits = 1 + int(random() % 3); hits > 0; --hits) {
      bytes[random() % bytes.size()] = char(random());
    }
    const auto loaded = read_scene(folder.write("d.ply", bytes), {}, {});
    if (!loaded.ok()) continue;
    ++survived;
    ASSERT_TRUE(test::sound(loaded->scene));
  }
  EXPECT_GT(survived, 0);
}

// The values are the least that each type holds, or the greatest where there is no sign.
TEST_P(PlyFormats, TypesOfEveryName) {
  const TempFolder folder;
  const auto positions = [&](const char* x, const char* y, const char* z, const auto&... values) {
    Writer w(GetParam(), std::string("element vertex 3\nproperty ") + x + " x\nproperty " + y +
                             " y\nproperty " + z +
                             " z\nelement face 1\nproperty list int8 uint8 vertex_indices\n");
    for (int i = 0; i < 3; ++i) {
      (w.put(values), ...);
      w.end();
    }
    w.put(std::int8_t{3});
    for (const int v : {0, 1, 2}) w.put(std::uint8_t(v));
    const auto loaded = read_scene(folder.write("n.ply", w.end().bytes()), {}, {});
    EXPECT_TRUE(loaded.ok()) << loaded.status().message();
    if (!loaded.ok()) return Vec3d{};
    const Vec3f p = loaded->scene.positions[0];
    return Vec3d{p.x, p.y, p.z};
  };
  const std::int8_t i8 = -128;
  const std::int16_t i16 = -32768;
  const std::int32_t i32 = -65536;
  EXPECT_EQ(positions("char", "short", "int", i8, i16, i32), (Vec3d{-128, -32768, -65536}));
  EXPECT_EQ(positions("int8", "int16", "int32", i8, i16, i32), (Vec3d{-128, -32768, -65536}));
  const std::uint8_t u8 = 255;
  const std::uint16_t u16 = 65535;
  const std::uint32_t u32 = 0x80000000u;
  EXPECT_EQ(positions("uchar", "ushort", "uint", u8, u16, u32), (Vec3d{255, 65535, 2147483648.0}));
  EXPECT_EQ(positions("uint8", "uint16", "uint32", u8, u16, u32),
            (Vec3d{255, 65535, 2147483648.0}));
  EXPECT_EQ(positions("float", "double", "float32", 1.5f, -2.25, 3.f), (Vec3d{1.5, -2.25, 3}));
  EXPECT_EQ(positions("float64", "float32", "double", 1.5, -2.25f, 3.0), (Vec3d{1.5, -2.25, 3}));
}

TEST_P(PlyFormats, ShortElementsAreNotTakenForACutFile) {
  const TempFolder folder;
  Writer w(GetParam(),
           "element vertex 40\nproperty char x\nproperty char y\nproperty char z\n"
           "element face 200\nproperty list uchar double vertex_indices\n");
  for (int i = 0; i < 40; ++i)
    w.put(std::int8_t(i % 2)).put(std::int8_t(i % 3)).put(std::int8_t{0}).end();
  w.put(std::uint8_t{3}).put(0.0).put(1.0).put(2.0).end();
  for (int i = 1; i < 200; ++i) w.put(std::uint8_t{0}).end();
  const auto loaded = read_scene(folder.write("s.ply", w.bytes()), {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.triangle_count(), 1u);
  EXPECT_EQ(loaded->defects.count(DefectKind::too_few_corners), 199u);
  EXPECT_EQ(loaded->defects.lines()[0].find("199 x "), 0u) << "not only those that are named";
  const bool ascii = std::string(GetParam()) == "ascii";
  EXPECT_NE(loaded->defects.lines()[0].find(ascii ? "s.ply:52," : "s.ply: face 1,"),
            std::string::npos)
      << loaded->defects.lines()[0];
}

// Strips have what their vertices have.
TEST_P(PlyFormats, StripsHaveTexcoordsAndNormals) {
  const TempFolder folder;
  Writer w(GetParam(),
           "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
           "property float s\nproperty float t\nproperty float nx\nproperty float ny\n"
           "property float nz\nelement tristrips 1\nproperty list int int vertex_indices\n");
  for (int i = 0; i < 4; ++i) {
    w.put(float(i / 2)).put(float(i % 2)).put(0.f).put(float(i)).put(0.5f);
    w.put(0.f).put(0.f).put(1.f).end();
  }
  for (const int v : {4, 0, 1, 2, 3}) w.put(v);
  const auto loaded = read_scene(folder.write("s.ply", w.end().bytes()), {.normals = true}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.texcoord_indices, loaded->scene.indices);
  EXPECT_EQ(loaded->scene.normal_indices, loaded->scene.indices);
}

// Programs name the same properties differently.
TEST(Ply, NamesOfColoursAndTexcoords) {
  const TempFolder folder;
  const std::array<const char*, 3> colours[] = {
      {"r", "g", "b"},
      {"illumination_r", "illumination_g", "illumination_b"},
      {"illuminance_r", "illuminance_g", "illuminance_b"},
      {"diffuse_red", "diffuse_green", "diffuse_blue"}};
  const std::array<const char*, 2> texcoords[] = {
      {"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}};
  for (const auto& names : colours) {
    for (const auto& uv : texcoords) {
      std::string header = "ply\nformat ascii 1.0\nobj_info none\nelement vertex 3\n";
      for (const char* name : {"x", "y", "z", names[0], names[1], names[2], uv[0], uv[1]})
        header += std::string("property float ") + name + "\n";
      const auto loaded = read_scene(
          folder.write("n.ply",
                       header + "element face 1\nproperty list uchar int vertex_indices\n"
                                "element vertex 0\nproperty float x\nend_header\n"
                                "0 0 0 1 2 3 .25 .5\n1 0 0 4 5 6 0 0\n0 1 0 7 8 9 0 0\n3 0 1 2\n"),
          {}, {});
      ASSERT_TRUE(loaded.ok()) << loaded.status().message();
      ASSERT_TRUE(loaded->scene.lit()) << names[0];
      EXPECT_EQ(loaded->scene.illumination[1], (Vec3f{4, 5, 6})) << names[0];
      ASSERT_FALSE(loaded->scene.texcoord_indices.empty()) << uv[0];
      EXPECT_EQ(loaded->scene.texcoords[0], (Vec2f{.25f, .5f})) << uv[0];
    }
  }
}

// Colours are decoded only where they are asked for, are not linear by their name, and lie within
// 0 to 1.
TEST(Ply, ColoursOfScansAreDecoded) {
  const TempFolder folder;
  const auto file = [&](const char* type, const std::array<const char*, 3>& names,
                        const char* values) {
    std::string header = "ply\nformat ascii 1.0\nelement vertex 3\n";
    for (const char* name : {"x", "y", "z"}) header += fmt::format("property float {}\n", name);
    for (const char* name : names) header += fmt::format("property {} {}\n", type, name);
    header += "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    return folder.write("c.ply",
                        header + fmt::format("0 0 0 {0}\n1 0 0 {0}\n0 1 0 {0}\n3 0 1 2\n", values));
  };
  const ReadOptions scan{.srgb_colours = true};
  const auto bytes = file("uchar", {"red", "green", "blue"}, "128 0 255");
  EXPECT_EQ(load(bytes).scene.illumination[1], (Vec3f{128 / 255.0f, 0, 1}));
  const Vec3f decoded = load(bytes, scan).scene.illumination[1];
  EXPECT_EQ(srgb_encode8(decoded.x), 128);
  EXPECT_EQ(decoded.y, 0);
  EXPECT_EQ(decoded.z, 1);
  const auto floats = file("float", {"red", "green", "blue"}, "0.5 2 -1");
  EXPECT_EQ(load(floats, scan).scene.illumination[0], (Vec3f{srgb_decode(0.5f), 2, -1}));
  const auto light = file("float", {"illuminance_r", "illuminance_g", "illuminance_b"}, "0.5 0 1");
  EXPECT_EQ(load(light, scan).scene.illumination[0], (Vec3f{0.5f, 0, 1}));
}

// MeshLab writes textures like this: a comment for each, and a number in each face.
TEST(Ply, TexturesAreNamedInComments) {
  const TempFolder folder;
  const auto path =
      folder.write("t.ply",
                   "ply\nformat ascii 1.0\ncomment TextureFile a b.png\ncomment TextureFile c.png\n"
                   "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                   "property float illuminance\n"
                   "element face 7\nproperty list uchar int vertex_indices\n"
                   "property list uchar float texcoord\nproperty int texnumber\nend_header\n"
                   "0 0 0 1\n1 0 0 2\n0 1 nan 3\n"
                   "3 0 1 1 6 0 0 1 0 0.5 1 1\n3 0 1 0 6 0 0 1 0 0 1 0\n3 0 0 1 6 0 0 1 0 0 1 7\n"
                   "3 0 1 2 6 0 0 1 0 0 1 0\n3 0 1 1 6 0 0 1 0 0 1 -1\n"
                   "3 0 1 1 6 0 0 1 0 0 1 2\n3 0 1 1 6 0 0 1 0 0 1 -2\n");
  const auto loaded = read_scene(path, {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  ASSERT_EQ(s.triangle_count(), 6u);
  ASSERT_EQ(s.materials.size(), 3u);
  EXPECT_EQ(s.materials[s.triangle_material[0]].name, "c.png");
  EXPECT_EQ(s.materials[s.triangle_material[1]].name, "a b.png");
  EXPECT_EQ(s.triangle_material[2], 2u);  // no texture has that number
  EXPECT_EQ(s.triangle_material[3], 2u);  // -1: the face has no texture
  EXPECT_EQ(s.triangle_material[4], 2u);
  EXPECT_EQ(s.triangle_material[5], 2u);
  EXPECT_EQ(s.materials[2].name, "");
  EXPECT_EQ(loaded->defects.count(DefectKind::material_unknown), 3u);
  EXPECT_EQ(s.texcoords[s.texcoord_indices[2]], (Vec2f{0.5f, 1}));
  EXPECT_EQ(s.illumination[1], (Vec3f{2, 2, 2}));
  EXPECT_EQ(loaded->defects.count(DefectKind::texture_missing), 2u);
  EXPECT_EQ(loaded->defects.count(DefectKind::bad_position_used), 1u);
  for (const Defect& d : loaded->defects.defects) {
    if (d.kind == DefectKind::position_not_finite) {
      EXPECT_EQ(d.first_places[0], path.string() + ":17");
    }
    if (d.kind == DefectKind::material_unknown) {
      EXPECT_EQ(
          d.first_places[0],
          path.string() + ":20: texnumber 7, but the textures are 0 to 1 (name all in the header)");
    }
  }
}

// A list must be read by its values. Its length, here 1, is no texture's number.
TEST(Ply, TextureNumbersInLists) {
  const TempFolder folder;
  const auto path =
      folder.write("t.ply",
                   "ply\nformat ascii 1.0\ncomment TextureFile a.png\ncomment TextureFile b.png\n"
                   "comment TextureFile c.png\nelement vertex 3\nproperty float x\n"
                   "property float y\nproperty float z\nelement face 6\n"
                   "property list uchar int vertex_indices\n"
                   "property list uchar int texnumber\nend_header\n"
                   "0 0 0\n1 0 0\n0 1 0\n"
                   "3 0 1 2 1 2\n3 0 1 2 1 0\n3 0 1 2 3 1 1 1\n3 0 1 2 3 1 1 2\n3 0 1 2 0\n"
                   "3 0 1 2 1 9\n");
  const auto loaded = read_scene(path, {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  std::vector<std::string> names;
  for (const std::uint32_t m : s.triangle_material) names.push_back(s.materials[m].name);
  EXPECT_EQ(names, (std::vector<std::string>{"c.png", "a.png", "b.png", "", "", ""}));
  EXPECT_EQ(loaded->defects.count(DefectKind::material_unknown), 2u);
  for (const Defect& d : loaded->defects.defects) {
    if (d.kind == DefectKind::material_unknown) {
      EXPECT_EQ(d.first_places[0],
                path.string() + ":20: texnumber has different values (give the face one)");
    }
  }
}

// Numbers mean nothing where no texture is named.
TEST(Ply, TextureNumbersWithoutTextures) {
  const TempFolder folder;
  const auto path = folder.write("t.ply",
                                 "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                                 "property float y\nproperty float z\nelement face 2\n"
                                 "property list uchar int vertex_indices\n"
                                 "property list uchar int texnumber\nend_header\n"
                                 "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 3 0 1 2\n3 0 1 2 1 0\n");
  const auto loaded = read_scene(path, {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.materials.size(), 1u);
  EXPECT_TRUE(loaded->defects.empty());
}

// What a scene has no arrays for is counted if the scene is to be kept.
TEST(Ply, CountsPropertiesThatASceneCannotHold) {
  const TempFolder folder;
  const auto path = folder.write(
      "t.ply",
      "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nproperty float nx\nproperty float ny\n"
      "property float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      "property uchar alpha\nproperty float quality\nelement face 2\n"
      "property list uchar int vertex_indices\nproperty list uchar float texcoord\n"
      "property int texnumber\nproperty uchar red\nproperty float alpha\nend_header\n"
      "0 0 0 0 0 1 9 9 9 255 1\n1 0 0 0 0 1 9 9 9 254 2\n0 1 0 0 0 1 9 9 9 0 3\n"
      "3 0 1 2 6 0 0 1 0 0 1 0 7 1\n3 0 1 2 6 0 0 1 0 0 1 0 8 1\n");
  ReadOptions options;
  options.keep_scene = true;
  options.load_textures = false;
  const auto kept = read_scene(path, options, {});
  ASSERT_TRUE(kept.ok()) << kept.status().message();
  EXPECT_EQ(kept->scene.not_read, (LossCounts{{"textures of materials", 1},
                                              {"values of faces: red", 2},
                                              {"values of vertices: alpha", 2},
                                              {"values of vertices: quality", 3}}));
  const auto read = read_scene(path, {}, {});
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read->scene.not_read, LossCounts{});
}

INSTANTIATE_TEST_SUITE_P(All, PlyFormats,
                         ::testing::Values("ascii", "binary_little_endian", "binary_big_endian"));

}  // namespace
}  // namespace atlas
