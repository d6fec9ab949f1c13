#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

#include "libatlas/scene/reader.h"
#include "tests/scene/sound.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::TempFolder;

Result<LoadedScene> load_off(const std::string& bytes) {
  const TempFolder folder;
  return read_scene(folder.write("a.off", bytes), {}, {});
}

Scene scene_of(const std::string& bytes) {
  auto loaded = load_off(bytes);
  EXPECT_TRUE(loaded.ok()) << loaded.status().message();
  return loaded.ok() ? std::move(loaded->scene) : Scene{};
}

const std::string kCorners = "0 0 0\n2 0 0\n2 3 0\n0 3 0\n";

// The keyword may be missing, have a line of its own, or touch the counts. Comments may be
// anywhere.
TEST(Off, HeadersAlike) {
  const Scene plain = scene_of("OFF\n4 1 0\n" + kCorners + "4 0 1 2 3\n");
  EXPECT_EQ(plain.indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
  EXPECT_EQ(plain.positions[2], (Vec3f{2, 3, 0}));
  EXPECT_FALSE(plain.lit());
  for (const char* header :
       {"4 1 0\n", "OFF 4 1 0\n", "OFF4 1 0 # as in ModelNet\n", "OFF\n4 1\n",
        "OFF # C:\\\n4 1 0 # there\\\n", "# by hand\n\nOFF # here\n\n# and\n 4 1 0 # there\n\n",
        "\t OFF\r\n4 1 0\r\n"}) {
    const Scene scene = scene_of(header + kCorners + "\n4 0 1 2 3 # end");
    EXPECT_EQ(scene.indices, plain.indices) << header;
    EXPECT_EQ(scene.positions, plain.positions) << header;
  }
  const Scene commented =
      scene_of("OFF\n4 1 0\n0 0 0 # a\n# b\n2 0 0\n\n2 3 0\n0 3 0\n4 0 1 2 3 255 0 0\n");
  EXPECT_EQ(commented.indices, plain.indices);
  EXPECT_EQ(commented.positions, plain.positions);
  EXPECT_EQ(scene_of("OFF\n4 1 0\n" + kCorners + "4 0\n1 2 # as some write it\n3\n").indices,
            plain.indices);
}

TEST(Off, NormalsColoursAndTexcoordsInThisOrder) {
  const Scene scene = scene_of(
      "STCNOFF\n3 1 0\n0 0 0 0 0 1 255 51 0 255 .25 .5\n1 0 0 0 0 1 0 0 0 255 1 0\n"
      "0 1 0 0 0 1 0 102 0 255 -2 3\n3 2 1 0\n");
  EXPECT_EQ(scene.illumination,
            (std::vector<Vec3f>{{1, 0.2f, 0}, {0, 0, 0}, {0, float(102 / 255.0), 0}}));
  EXPECT_EQ(scene.texcoords, (std::vector<Vec2f>{{.25f, .5f}, {1, 0}, {-2, 3}}));
  EXPECT_EQ(scene.texcoord_indices, scene.indices);
  const Scene bare = scene_of("NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n");
  EXPECT_FALSE(bare.lit());
  EXPECT_TRUE(bare.texcoords.empty());
  EXPECT_TRUE(bare.normals.empty()) << "they are not asked for";
}

const std::string kTwoFaces = "OFF\n4 2 0\n" + kCorners;

std::vector<Vec3f> corner_light(const Scene& scene) {
  std::vector<Vec3f> result;
  for (const std::uint32_t v : scene.indices)
    if (scene.lit()) result.push_back(scene.illumination[v]);
  return result;
}

// Colours of faces follow the scale of those of vertices, and are those of all their corners.
TEST(Off, ColoursOfFaces) {
  const auto light = [](const char* a, const char* b) {
    return corner_light(scene_of(kTwoFaces + "3 0 1 2 " + a + "\n3 0 2 3 " + b + "\n"));
  };
  const auto both = [](Vec3f a, Vec3f b) { return std::vector<Vec3f>{a, a, a, b, b, b}; };
  EXPECT_EQ(light("51 0 255", "1 1 1"), both({0.2f, 0, 1}, {1 / 255.f, 1 / 255.f, 1 / 255.f}));
  EXPECT_EQ(light("51 0 255 255 # red", "0 0 0 255"), both({0.2f, 0, 1}, {0, 0, 0}));
  EXPECT_EQ(light("0.5 0 1", "1 1 1"), both({0.5f, 0, 1}, {1, 1, 1}));
  EXPECT_EQ(light("1 0 0", "0 0 1"), both({1, 0, 0}, {0, 0, 1}));
  EXPECT_EQ(light("1 0 0 0.5", "0 3 1 1"), both({1 / 255.f, 0, 0}, {0, 3 / 255.f, 1 / 255.f}));
  EXPECT_EQ(light("", ""), std::vector<Vec3f>{});
  // Indices into a map of colours are in no file.
  EXPECT_EQ(light("7", "3"), std::vector<Vec3f>{});
}

TEST(Off, FacesShareVerticesWhereTheirColoursAgree) {
  EXPECT_EQ(scene_of(kTwoFaces + "3 0 1 2 9 8 7\n3 0 2 3 9 8 7\n").positions.size(), 4u);
  const Scene scene = scene_of(kTwoFaces + "3 0 1 2 9 8 7\n3 0 2 3 9 8 6\n");
  EXPECT_EQ(scene.positions.size(), 6u);
  for (std::size_t k = 0; k < 6; ++k) {
    const Vec3f p = scene.positions[scene.indices[k]];
    const Vec3f corners[] = {{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 0, 0}, {2, 3, 0}, {0, 3, 0}};
    EXPECT_EQ(p, corners[k]);
  }
}

TEST(Off, FacesWithoutAColourAreDark) {
  const auto loaded = load_off(kTwoFaces + "3 0 1 2\n3 0 2 3 255 0 0\n");
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Vec3f red{1, 0, 0};
  EXPECT_EQ(corner_light(loaded->scene), (std::vector<Vec3f>{{}, {}, {}, red, red, red}));
  EXPECT_EQ(loaded->defects.count(DefectKind::illumination_missing), 3u);
}

// Colours of vertices say more, and those of faces are told to be ignored.
TEST(Off, ColoursOfVerticesComeFirst) {
  const auto loaded =
      load_off("COFF\n3 1 0\n0 0 0 255 0 0\n1 0 0 0 0 0\n0 1 0 0 0 0\n3 0 1 2 0 255 0\n");
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.illumination[0], (Vec3f{1, 0, 0}));
  ASSERT_EQ(loaded->defects.count(DefectKind::element_ignored), 1u);
  EXPECT_NE(loaded->defects.lines()[0].find("colours of faces"), std::string::npos);
}

TEST(Off, IndicesBeyondTheVerticesReachNoCopies) {
  const auto loaded = load_off(kTwoFaces + "3 0 1 2 9 8 7\n3 0 2 4 9 8 6\n");
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.triangle_count(), 1u);
}

TEST(Off, AlphaOfFacesIsKept) {
  const TempFolder folder;
  const auto path = folder.write("a.off", kTwoFaces + "3 0 1 2 255 0 0 51\n3 0 2 3 255 0 0\n");
  const auto loaded = read_scene(path, {.rest = true}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& scene = loaded->scene;
  ASSERT_EQ(scene.vertex_opacity.size(), 6u);
  for (std::size_t k = 0; k < 6; ++k)
    EXPECT_EQ(scene.vertex_opacity[scene.indices[k]], k < 3 ? 0.2f : 1);
}

// Every element is as short as the format allows.
TEST(Off, ShortElementsAreNotTakenForACutFile) {
  std::string vertices, faces;
  for (int i = 0; i < 40; ++i) {
    vertices += i % 2 ? "1 0 0\n" : i % 4 ? "0 1 0\n" : "0 0 0\n";
    faces += "\n0";
  }
  EXPECT_EQ(scene_of("OFF\n40 41 0\n" + vertices + "3 0 1 2" + faces).triangle_count(), 1u);
}

// Whole numbers up to 255 are divided by 255. Fractions and larger values are used unchanged.
TEST(Off, ScalesOfColours) {
  const auto first = [](const char* a, const char* b) {
    return scene_of(std::string("COFF\n3 1 0\n0 0 0 ") + a + "\n1 0 0 " + b + "\n0 1 0 " + b +
                    "\n3 0 1 2\n")
        .illumination[0];
  };
  EXPECT_EQ(first("51 0 255", "1 1 1"), (Vec3f{0.2f, 0, 1}));
  EXPECT_EQ(first("1 0 0", "0 0 1"), (Vec3f{1, 0, 0}));
  EXPECT_EQ(first("0.5 0 1", "1 1 1"), (Vec3f{0.5f, 0, 1}));
  EXPECT_EQ(first("200 0 1", "0.5 1 1"), (Vec3f{200, 0, 1}));
  EXPECT_EQ(first("200 0 1", "1 4000 1"), (Vec3f{200, 0, 1}));
  EXPECT_EQ(first("2E2 0 1", "1 1 1"), (Vec3f{200, 0, 1}));
  EXPECT_EQ(first("200 0 1", "nan 1 1"), (Vec3f{200, 0, 1}));
  EXPECT_EQ(first("51 0 1 1.0", "1 1 1 .5"), (Vec3f{0.2f, 0, float(1 / 255.0)}));
}

TEST(Off, VerticesHaveAllTheirNumbers) {
  const auto taken = [](const std::string& header, int numbers) {
    std::string vertex;
    for (int i = 0; i < numbers; ++i) vertex += "1 ";
    const auto loaded = load_off(header + "\n3 1 0\n" + vertex + "\n" + vertex + "\n" + vertex +
                                 "\n3 0 1 2\n# " + std::string(40, '-') + "\n");
    if (!loaded.ok()) {
      EXPECT_NE(loaded.status().message().find("it has " + std::to_string(numbers)),
                std::string::npos)
          << loaded.status().message();
    }
    return loaded.ok();
  };
  // More numbers than a header without colours explains are ignored.
  for (int n = 1; n < 15; ++n) {
    EXPECT_EQ(taken("OFF", n), n >= 3) << n;
    EXPECT_EQ(taken("NOFF", n), n >= 6) << n;
    EXPECT_EQ(taken("STOFF", n), n >= 5) << n;
    EXPECT_EQ(taken("COFF", n), n == 6 || n == 7) << n;
    EXPECT_EQ(taken("STCNOFF", n), n == 11 || n == 12) << n;
  }
}

TEST(Off, DefectsAreCounted) {
  const auto loaded = load_off(
      "OFF\n4 5 0\n0 0 0 9 9\n2 0 0\nnan 3 0\n0 3 0\n3 0 1 3\n3 0 1 2\n3 0 1 4\n3 0 1 -1\n2 0 1\n"
      "3 0 1 3\n");
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.triangle_count(), 1u);
  EXPECT_EQ(loaded->defects.count(DefectKind::position_not_finite), 1u);
  EXPECT_EQ(loaded->defects.count(DefectKind::bad_position_used), 1u);
  EXPECT_EQ(loaded->defects.count(DefectKind::index_out_of_range), 2u);
  EXPECT_EQ(loaded->defects.count(DefectKind::too_few_corners), 1u);
  // Two numbers that the header does not explain, and one face more than it announces.
  EXPECT_EQ(loaded->defects.count(DefectKind::element_ignored), 2u);
  const std::string lines = loaded->defects.lines().back();
  EXPECT_NE(lines.find("a.off:3, the last 2 numbers"), std::string::npos) << lines;
  EXPECT_NE(lines.find("a.off:12"), std::string::npos) << lines;
}

TEST(Off, FarCoordinatesKeepTheirDigits) {
  const Scene scene = scene_of(
      "OFF\n3 1 0\n1000000.001 5000000.002 0\n1000000.002 5000000.002 0\n"
      "1000000.001 5000000.003 0\n3 0 1 2\n");
  const auto x = [&](int i) { return scene.origin.x + double(scene.positions[i].x); };
  EXPECT_NEAR(x(1) - x(0), 0.001, 1e-9);
}

// Binary files as Geomview has them (big-endian, faces with the number of their colour's
// components), and as OpenMesh writes them (little-endian, without that number).
class BinaryOff : public ::testing::TestWithParam<bool> {
 protected:
  std::string bytes_ = "OFF BINARY\n";

  void word(std::uint32_t v) {
    const bool big = GetParam();
    for (int i = 0; i < 4; ++i) bytes_ += char(v >> 8 * (big ? 3 - i : i));
  }
  void number(float v) { word(std::bit_cast<std::uint32_t>(v)); }

  void square(bool colours) {
    if (colours) bytes_ = "C" + bytes_;
    for (const std::uint32_t v : {4u, 2u, 0u}) word(v);
    for (const float x : {0.f, 1.f, 2.f, 3.f}) {
      for (const float v : {x, x * x, 1.f}) number(v);
      if (colours) {
        for (const float v : {100 * x, .5f, -1.f, 1.f}) number(v);
      }
    }
    for (const std::uint32_t v : {3u, 0u, 1u, 2u}) word(v);
    if (GetParam()) word(0);
    for (const std::uint32_t v : {4u, 3u, 2u, 1u, 0u}) word(v);
    if (GetParam()) {
      word(3);
      for (int i = 0; i < 3; ++i) number(0.5f);
    }
  }
};

TEST_P(BinaryOff, IsRead) {
  for (const bool colours : {false, true}) {
    bytes_ = "OFF BINARY\n";
    square(colours);
    const Scene scene = scene_of(bytes_);
    EXPECT_EQ(scene.triangle_count(), 3u);
    ASSERT_GE(scene.positions.size(), 4u);
    EXPECT_EQ(scene.positions[3], (Vec3f{3, 9, 1}));
    // Only Geomview's form has colours of faces.
    ASSERT_EQ(scene.lit(), colours || GetParam());
    if (colours) {
      EXPECT_EQ(scene.illumination[2], (Vec3f{200, .5f, -1}));
    } else if (GetParam()) {
      for (std::size_t k = 0; k < 9; ++k)
        EXPECT_EQ(scene.illumination[scene.indices[k]].y, k < 3 ? 0 : 0.5f);
    }
  }
}

TEST_P(BinaryOff, NormalsColoursAndTexcoordsInThisOrder) {
  bytes_ = "STCNOFF BINARY\n";
  for (const std::uint32_t v : {3u, 1u, 0u}) word(v);
  for (int i = 0; i < 3; ++i) {
    for (const float v : {float(i), float(i * i), 0.f}) number(v);    // position
    for (const float v : {0.f, 0.6f, 0.8f}) number(v);                // normal
    for (const float v : {1.f, 2.f, 3.f + float(i), 1.f}) number(v);  // colour
    for (const float v : {0.25f, float(i)}) number(v);                // texture coordinate
  }
  for (const std::uint32_t v : {3u, 0u, 1u, 2u}) word(v);
  if (GetParam()) word(0);
  const Scene scene = scene_of(bytes_);
  EXPECT_EQ(scene.positions, (std::vector<Vec3f>{{0, 0, 0}, {1, 1, 0}, {2, 4, 0}}));
  EXPECT_EQ(scene.illumination, (std::vector<Vec3f>{{1, 2, 3}, {1, 2, 4}, {1, 2, 5}}));
  EXPECT_EQ(scene.texcoords, (std::vector<Vec2f>{{.25f, 0}, {.25f, 1}, {.25f, 2}}));
  EXPECT_TRUE(scene.normals.empty()) << "they are not asked for";
  const TempFolder folder;
  const auto asked = read_scene(folder.write("n.off", bytes_), {.normals = true}, {});
  ASSERT_TRUE(asked.ok()) << asked.status().message();
  EXPECT_EQ(asked->scene.normals, std::vector<Vec3f>(3, {0, 0.6f, 0.8f}));
}

TEST_P(BinaryOff, DefectsAreNamedByTheirNumbers) {
  for (const std::uint32_t v : {4u, 3u, 0u}) word(v);
  for (const float x : {0.f, NAN, 1.f, 2.f}) {
    for (const float v : {x, x * x, 1.f}) number(v);
  }
  const auto face = [&](std::uint32_t last) {
    for (const std::uint32_t v : {3u, 0u, 2u, last}) word(v);
    if (GetParam()) word(0);
  };
  face(3);
  face(4);
  face(1);
  const auto loaded = load_off(bytes_);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.triangle_count(), 1u);
  const std::vector<std::string> lines = loaded->defects.lines();
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_NE(lines[0].find("a.off: face 1)"), std::string::npos) << lines[0];
  EXPECT_NE(lines[1].find("a.off: face 2)"), std::string::npos) << lines[1];
  EXPECT_NE(lines[2].find("a.off: vertex 1)"), std::string::npos) << lines[2];
}

// Faces of fewer corners are only told apart from colours where these are counted.
TEST_P(BinaryOff, FacesOfTwoCornersNeedCountedColours) {
  for (const std::uint32_t v : {3u, 2u, 0u}) word(v);
  for (int i = 0; i < 3; ++i) {
    for (const float v : {float(i), float(i * i), 0.f}) number(v);
  }
  for (const std::uint32_t v : {3u, 0u, 1u, 2u}) word(v);
  if (GetParam()) word(0);
  for (const std::uint32_t v : {2u, 0u, 1u}) word(v);
  if (GetParam()) word(0);
  const auto loaded = load_off(bytes_);
  ASSERT_EQ(loaded.ok(), GetParam());
  if (GetParam()) {
    EXPECT_EQ(loaded->defects.count(DefectKind::too_few_corners), 1u);
  }
}

// The data must end at the file's end, or the bytes are not what the header says.
TEST_P(BinaryOff, BytesAfterTheLastFaceAreRefused) {
  square(false);
  for (int more = 1; more < 9; ++more) {
    bytes_ += 'x';
    EXPECT_EQ(load_off(bytes_).status().code(), ErrorCode::bad_input) << more;
  }
}

TEST_P(BinaryOff, EveryTruncationIsNoticed) {
  square(true);
  for (std::size_t length = 0; length < bytes_.size(); ++length) {
    const auto loaded = load_off(bytes_.substr(0, length));
    ASSERT_FALSE(loaded.ok()) << length;
    EXPECT_EQ(loaded.status().code(), ErrorCode::bad_input);
  }
}

INSTANTIATE_TEST_SUITE_P(Both, BinaryOff, ::testing::Bool(),
                         [](const auto& test) { return test.param ? "geomview" : "openmesh"; });

TEST(Off, EveryTruncationIsNoticed) {
  const std::string bytes = "COFF\n3 1 0\n0 0 0 1 2 3\n1 0 0 1 2 3\n0 1 0 1 2 3\n3 0 1 2\n";
  for (std::size_t length = 0; length + 1 < bytes.size(); ++length) {
    const auto loaded = load_off(bytes.substr(0, length));
    ASSERT_FALSE(loaded.ok()) << length;
    EXPECT_NE(loaded.status().message().find("a.off"), std::string::npos);
  }
}

TEST(Off, RandomDamageNeverCrashes) {
  const std::string good =
      "STCOFF\n4 2 0\n0 0 0 1 2 3 0 0\n1 0 0 1 2 3 0 1\n0 1 0 1 2 3 1 1\n1 1 1 1 2 3 0 0\n"
      "3 0 1 2\n4 0 1 2 3 1 1 1\n";
  std::mt19937 random(5);
  int survived = 0;
  for (int round = 0; round < 1500; ++round) {
    std::string bytes = good;
    for (int hits = 1 + int(random() % 3); hits > 0; --hits) {
      bytes[random() % bytes.size()] = round % 2 ? char(random()) : char('0' + random() % 10);
    }
    const auto loaded = load_off(bytes);
    if (!loaded.ok()) continue;
    ++survived;
    ASSERT_TRUE(test::sound(loaded->scene));
  }
  EXPECT_GT(survived, 100);
}

}  // namespace
}  // namespace atlas
