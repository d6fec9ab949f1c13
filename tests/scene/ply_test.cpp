// Tests that the formats of PLY, ascii and binary, are read alike, whatever the types.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "libatlas/scene/reader.h"
#include "tests/scene/sound.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

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

// The format allows any order of elements.
TEST_P(PlyFormats, FacesMayComeBeforeVertices) {
  const TempFolder folder;
  const std::string faces =
      "element face 1\nproperty list uchar int vertex_indices\nproperty list uchar float "
      "texcoord\n";
  const std::string strips = "element tristrips 1\nproperty list uchar int vertex_indices\n";
  const std::string other = "element camera 1\nproperty uchar view\n";
  const std::string vertices =
      "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
  Writer w(GetParam(), faces + other + strips + vertices);
  w.put(std::uint8_t{3});
  for (const int v : {0, 1, 2}) w.put(std::int32_t(v));
  w.put(std::uint8_t{6});
  for (const int k : {0, 0, 1, 0, 1, 1}) w.put(float(k));
  w.end().put(std::uint8_t{7}).end().put(std::uint8_t{3});
  for (const int v : {1, 3, 2}) w.put(std::int32_t(v));
  w.end();
  for (const int v : {0, 1, 2, 3}) w.put(float(v % 2)).put(float(v / 2)).put(0.f).end();
  const auto loaded = read_scene(folder.write("a.ply", w.bytes()), {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  EXPECT_EQ(s.indices, (std::vector<std::uint32_t>{0, 1, 2, 1, 3, 2}));
  ASSERT_EQ(s.texcoord_indices.size(), 6u);
  EXPECT_EQ(s.texcoords[s.texcoord_indices[2]], (Vec2f{1, 1}));
  ASSERT_EQ(loaded->defects.defects.size(), 1u);  // the camera
  EXPECT_EQ(loaded->defects.defects[0].count, 1u);
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
  EXPECT_GT(survived, 50);
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

INSTANTIATE_TEST_SUITE_P(All, PlyFormats,
                         ::testing::Values("ascii", "binary_little_endian", "binary_big_endian"));

}  // namespace
}  // namespace atlas
