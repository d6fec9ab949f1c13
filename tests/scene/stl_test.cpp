#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "libatlas/scene/reader.h"
#include "tests/scene/sound.h"
#include "tests/support/foreign_locale.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::TempFolder;
using Triangle = std::array<Vec3d, 3>;

Result<LoadedScene> load_stl(const std::string& bytes) {
  const TempFolder folder;
  return read_scene(folder.write("a.stl", bytes), {}, {});
}

std::string binary(const std::vector<Triangle>& triangles,
                   std::string header = "solid but binary") {
  header.resize(80, ' ');
  const auto append = [&](const auto& value) {
    header.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  append(std::uint32_t(triangles.size()));
  for (const Triangle& t : triangles) {
    for (int i = 0; i < 3; ++i) append(0.f);
    for (const Vec3d& p : t) {
      for (const double c : {p.x, p.y, p.z}) append(float(c));
    }
    append(std::uint16_t{0x8123});
  }
  return header;
}

std::string text(const std::vector<Triangle>& triangles) {
  std::string out = "solid one\n";
  for (const Triangle& t : triangles) {
    out += "  facet normal 0 0 1\n    outer loop\n";
    for (const Vec3d& p : t) out += fmt::format("      vertex {} {} {}\n", p.x, p.y, p.z);
    out += "    endloop\n  endfacet\n";
  }
  return out + "endsolid one\n";
}

const std::vector<Triangle> kFan{{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
                                 {{{1, 0, 0}, {1, 1, 0.5}, {0, 1, 0}}},
                                 {{{-0.0, 1, 0}, {1, 1, 0.5}, {0, 2, 0}}}};

// Corners at the same place become one vertex. Vertices are numbered in the order of the file.
TEST(Stl, SoupIsJoined) {
  for (const std::string& bytes : {binary(kFan), binary(kFan, ""), text(kFan)}) {
    const auto loaded = load_stl(bytes);
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    const Scene& s = loaded->scene;
    EXPECT_TRUE(loaded->defects.empty());
    EXPECT_EQ(s.indices, (std::vector<std::uint32_t>{0, 1, 2, 1, 3, 2, 2, 3, 4}));
    EXPECT_EQ(s.positions,
              (std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.5f}, {0, 2, 0}}));
  }
}

TEST(Stl, ManyVertices) {
  std::vector<Triangle> grid;
  const auto at = [](int x, int y) { return Vec3d{x * 0.1, y * 0.1, 0}; };
  for (int x = 0; x < 60; ++x) {
    for (int y = 0; y < 60; ++y) {
      grid.push_back({{at(x, y), at(x + 1, y), at(x, y + 1)}});
      grid.push_back({{at(x + 1, y + 1), at(x, y + 1), at(x + 1, y)}});
    }
  }
  for (const std::string& bytes : {binary(grid), text(grid)}) {
    const auto loaded = load_stl(bytes);
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    EXPECT_EQ(loaded->scene.positions.size(), 61u * 61u);
    EXPECT_EQ(loaded->scene.triangle_count(), 7200u);
  }
}

// Names that contain characters for comments or joined lines, keywords in any case, several solids,
// and loops of more corners, all of it on few lines.
TEST(Stl, TextAsProgramsWriteIt) {
  const auto loaded = load_stl(
      "\r\nSOLID C:\\parts\\#1 facet\\\r\nFACET NORMAL nan nan nan OUTER LOOP VERTEX 0 0 0 VERTEX "
      "1 "
      "0 0\nvertex 1 1 0\nvertex +0.0 1e0 0\nENDLOOP ENDFACET\nEndSolid\n\nsolid\nfacet outer "
      "loop\n"
      "vertex 0 0 0 vertex 0 0 1 vertex 1 0 0\nendloop endfacet\nfacet normal 0 0 0\nouter loop\n"
      "endloop\nendfacet\nendsolid two");
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.object_names, (std::vector<std::string>{"C:\\parts\\#1 facet\\", ""}));
  EXPECT_EQ(loaded->scene.triangle_object, (std::vector<std::uint32_t>{0, 0, 1}));
  EXPECT_EQ(loaded->scene.positions.size(), 5u);
  EXPECT_EQ(loaded->defects.count(DefectKind::too_few_corners), 1u);
}

TEST(Stl, DefectsAreCounted) {
  std::vector<Triangle> triangles = kFan;
  triangles[1][1].y = NAN;
  triangles[2][1].y = NAN;
  for (const std::string& bytes : {binary(triangles) + "more", text(triangles)}) {
    const auto loaded = load_stl(bytes);
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    EXPECT_EQ(loaded->scene.triangle_count(), 1u);
    EXPECT_EQ(loaded->defects.count(DefectKind::bad_position_used), 2u);
    EXPECT_EQ(loaded->defects.count(DefectKind::position_not_finite), 1u);
    if (bytes.starts_with("solid b")) {
      EXPECT_NE(loaded->defects.lines().back().find("4 bytes after triangle 3"), std::string::npos);
    }
  }
}

TEST(Stl, DefectsAreNamedByTheirPlaces) {
  std::vector<Triangle> triangles = kFan;
  triangles[1][1].y = NAN;
  const auto places = [&](const std::string& bytes) {
    const auto loaded = load_stl(bytes);
    EXPECT_TRUE(loaded.ok()) << loaded.status().message();
    std::string all;
    for (const std::string& line : loaded->defects.lines())
      all += line.substr(line.rfind("a.stl") + 5) + ";";
    return all;
  };
  EXPECT_EQ(places(binary(triangles)), ": triangle 1);: triangle 1);");
  // The facet is named where it begins, the position where its corner is.
  EXPECT_EQ(places(text(triangles)), ":9);:12);");
}

// What begins with 'solid' is text, unless the size says otherwise or a zero is near.
TEST(Stl, TextAndBinaryAreToldApart) {
  EXPECT_EQ(load_stl("\xef\xbb\xbf \n\t" + text(kFan)).status().message(), "");
  const Status longer = load_stl("solid" + std::string(100, ' ') + std::string(40, '\0')).status();
  EXPECT_NE(longer.message().find("triangles are announced"), std::string::npos)
      << longer.message();
}

TEST(Stl, FarCoordinatesKeepTheirDigits) {
  const double x = 1000000.001;
  const auto loaded = load_stl(text({{{{x, 0, 0}, {x + 0.001, 0, 0}, {x, 0.001, 0}}}}));
  ASSERT_TRUE(loaded.ok());
  const Scene& s = loaded->scene;
  EXPECT_NEAR(s.origin.x + double(s.positions[1].x), x + 0.001, 1e-9);
}

TEST(Stl, EveryTruncationIsNoticed) {
  for (const std::string& bytes : {binary(kFan), text(kFan)}) {
    const std::size_t needed = bytes.size() - (bytes.back() == '\n' ? 5 : 0);
    for (std::size_t length = 0; length < needed; ++length) {
      const auto loaded = load_stl(bytes.substr(0, length));
      ASSERT_FALSE(loaded.ok()) << length;
      EXPECT_EQ(loaded.status().code(), ErrorCode::bad_input);
      EXPECT_NE(loaded.status().message().find("a.stl"), std::string::npos);
    }
  }
}

TEST(Stl, RandomDamageNeverCrashes) {
  std::mt19937 random(5);
  int survived = 0;
  for (int round = 0; round < 1500; ++round) {
    std::string bytes = round % 2 ? binary(kFan, "") : text(kFan);
    for (int hits = 1 + int(random() % 3); hits > 0; --hits) {
      bytes[random() % bytes.size()] = char(random());
    }
    const auto loaded = load_stl(bytes);
    if (!loaded.ok()) continue;
    ++survived;
    ASSERT_TRUE(test::sound(loaded->scene));
  }
  EXPECT_GT(survived, 100);
}

// In Turkish, the small letter of I has no dot.
TEST(Stl, KeywordsAreTheSameInEveryLocale) {
  const test::ForeignLocale turkish(LC_CTYPE, "tr_TR", "ISO-8859-9");
  if (!turkish.entered()) GTEST_SKIP() << "no Turkish locale can be made here";
  const test::TempFolder folder;
  const auto file = folder.write("s.stl",
                                 "SOLID s\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\n"
                                 "VERTEX 1 0 0\nVERTEX 0 1 0\nENDLOOP\nENDFACET\nENDSOLID s\n");
  const auto loaded = read_scene(file, {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.triangle_count(), 1u);
}

}  // namespace
}  // namespace atlas
