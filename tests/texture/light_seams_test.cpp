#include "libatlas/texture/light_seams.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "tests/support/lit_sheets.h"

namespace atlas::test {
namespace {

TEST(LightSeams, AreTheCreasesWhereLightJumps) {
  const Sheets sheets = corner(4, constant(0.8), constant(0.3));
  const LightSeams seams = sheets.seams();
  EXPECT_NEAR(seams.length, 1, 1e-6);
  const Scene& scene = sheets.loaded().scene;
  ASSERT_EQ(seams.edges.size(), scene.indices.size());
  for (std::uint32_t h = 0; h < seams.edges.size(); ++h) {
    const std::uint32_t next = h % 3 == 2 ? h - 2 : h + 1;
    const Vec3f a = scene.positions[scene.indices[h]], b = scene.positions[scene.indices[next]];
    const bool along = a.x == 1 && b.x == 1 && a.z == 0 && b.z == 0;
    EXPECT_EQ(seams.edges[h] != 0, along) << h;
  }
}

TEST(LightSeams, AreNotWhereLightContinuesOrTheJumpIsNotVisible) {
  EXPECT_TRUE(corner(4, constant(0.5), constant(0.5)).seams().edges.empty());
  EXPECT_TRUE(corner(4, constant(0.5), constant(0.48)).seams().edges.empty());
  EXPECT_FALSE(corner(4, constant(0.5), constant(0.4)).seams().edges.empty());
  // Above white both are white.
  EXPECT_TRUE(corner(4, constant(5), constant(50)).seams().edges.empty());
  // A floor that continues as a floor, with other light.
  EXPECT_TRUE(Sheets()
                  .add({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, constant(0.8))
                  .add({1, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, constant(0.2))
                  .seams()
                  .edges.empty());
}

TEST(LightSeams, RunAlongAWholeCreaseOrNotAtAll) {
  const LightAt half = [](Vec3f p) { return p.y > 0.45 ? 0.2 : 0.5; };
  EXPECT_NEAR(corner(16, constant(0.5001), half).seams().length, 1, 1e-6);
  const LightAt end = [](Vec3f p) { return p.y > 0.9 ? 0.2 : 0.5; };
  EXPECT_EQ(corner(16, constant(0.5001), end).seams().length, 0);
}

TEST(LightSeams, LeaveFacesTogetherThatAreFewTexelsWide) {
  const Sheets leg = Sheets()
                         .add({0, 0, 0}, {0.02f, 0, 0}, {0, 1, 0}, 4, constant(0.8))
                         .add({0.02f, 0, 0}, {0, 0, 0.02f}, {0, 1, 0}, 4, constant(0.3));
  EXPECT_NEAR(leg.seams(0.005).length, 1, 1e-6);  // width: 2 area / seam = 8 texels
  EXPECT_EQ(leg.seams(0.0101).length, 0);
}

// Counts with the mean of the jumps at both ends of an edge.
TEST(LightSeams, AreAtEdgesWithAJumpAtOneEnd) {
  const LightAt rising = [](Vec3f p) { return p.y > 0.5 ? 0.8 : 0.3; };
  EXPECT_NEAR(corner(1, rising, constant(0.3)).seams().length, 1, 1e-6);
  EXPECT_NEAR(corner(1, constant(0.3), rising).seams().length, 1, 1e-6);
  const LightAt hardly = [](Vec3f p) { return p.y > 0.5 ? 0.33 : 0.3; };
  EXPECT_TRUE(corner(1, hardly, constant(0.3)).seams().edges.empty());
}

// A floor of strips one beside the other, of other light each, and a wall at its side x = 1.
Sheets strips_and_wall(int strips, Vec3f wall_from) {
  Sheets sheets;
  const auto wide = 1 / float(strips);
  for (int i = 0; i < strips; ++i)
    sheets.add({wide * float(i), 0, 0}, {wide, 0, 0}, {0, 1, 0}, 1, constant(i % 2 ? 0.8 : 0.2));
  sheets.add(wall_from, {0, 0, 1}, {0, 1, 0}, 1, constant(0.5));
  return sheets;
}

// Strips of light on a floor belong to one face, whose width is that of the floor.
TEST(LightSeams, OfAFaceDoNotDependOnItsStripes) {
  EXPECT_NEAR(strips_and_wall(5, {1, 0, 0}).seams(0.1).length, 1, 1e-6);
  EXPECT_NEAR(strips_and_wall(1, {1, 0, 0}).seams(0.1).length, 1, 1e-6);
  EXPECT_EQ(strips_and_wall(5, {1, 0, 0}).seams(0.51).length, 0);
}

// Where light is constant per triangle, nothing tells what is the line below a wall.
TEST(LightSeams, AreNotBelowWallsOnThinStripes) {
  EXPECT_NEAR(strips_and_wall(10, {0.5, -0.05f, -0.3f}).seams(0.01).length, 1, 1e-6);
  EXPECT_EQ(strips_and_wall(50, {0.5, -0.05f, -0.3f}).seams(0.006).length, 0);
}

// A partition on a floor of two layers. Each layer continues beyond it with the same light; only
// the other layer's is another.
TEST(LightSeams, ALayerOfAFloorIsContinuedByItself) {
  Sheets sheets;
  for (const float x : {0.0f, 1.0f}) {
    sheets.add({x, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, constant(0.8))
        .add({x, 0, 0}, {0, 1, 0}, {1, 0, 0}, 4, constant(0.2));
  }
  sheets.add({1, 0, 0}, {0, 0, 1}, {0, 1, 0}, 4, constant(0.5));
  const LightSeams seams = sheets.seams();
  const Scene& scene = sheets.loaded().scene;
  ASSERT_EQ(seams.edges.size(), scene.indices.size());
  for (std::uint32_t h = 0; h < 4 * 32 * 3; ++h) {
    const std::uint32_t next = h % 3 == 2 ? h - 2 : h + 1;
    const Vec3f a = scene.positions[scene.indices[h]], b = scene.positions[scene.indices[next]];
    if (a.x == 1 && b.x == 1) {
      EXPECT_EQ(seams.edges[h], 0) << h;
    }
  }
}

// Floor, floor beyond and a wall between the two: the floors continue each other.
TEST(LightSeams, OfThreeSheetsAtAnEdgeThoseThatContinueEachOtherStayTogether) {
  const Sheets sheets = Sheets()
                            .add({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 2, constant(0.8))
                            .add({1, 0, 0}, {1, 0, 0}, {0, 1, 0}, 2, constant(0.8))
                            .add({1, 0, 0}, {0, 0, 1}, {0, 1, 0}, 2, constant(0.2));
  const LightSeams seams = sheets.seams();
  EXPECT_NEAR(seams.length, 1, 1e-6);
  for (std::uint32_t h = 0; h < 2 * 8 * 3; ++h) EXPECT_EQ(seams.edges[h], 0) << h;
}

// The floor of two rooms, of 4 x 4 quads each, and the partition between them, lit on both sides.
Sheets two_rooms(double here, double there) {
  return Sheets()
      .add({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, constant(here))
      .add({1, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, constant(there))
      .add({1, 0, 0}, {0, 0, 1}, {0, 1, 0}, 4, constant(here))
      .add({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 4, constant(there));
}

// Otherwise the light of a bright room shows as a line in the dark one.
TEST(LightSeams, PartAFloorBelowAPartitionWhereTheLightJumps) {
  const Sheets sheets = two_rooms(0.8, 0.1);
  const LightSeams seams = sheets.seams();
  const Scene& scene = sheets.loaded().scene;
  ASSERT_EQ(seams.edges.size(), scene.indices.size());
  EXPECT_NEAR(seams.length, 4, 1e-6);  // with the other three sides of the partition
  for (std::uint32_t h = 0; h < 2 * 32 * 3; ++h) {
    const std::uint32_t next = h % 3 == 2 ? h - 2 : h + 1;
    const Vec3f a = scene.positions[scene.indices[h]], b = scene.positions[scene.indices[next]];
    EXPECT_EQ(seams.edges[h] != 0, a.x == 1 && b.x == 1) << h;
  }
  EXPECT_TRUE(two_rooms(0.8, 0.8).seams().edges.empty());
}

// Two floors of 4 x 4 quads that meet at x = 1, and a wall over `length` there with other vertices.
LightSeams seams_of_floors(Vec3f wall_from, float length, double texel) {
  Sheets sheets;
  sheets.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, constant(0.8))
      .add({1, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, constant(0.1))
      .add(wall_from, {0, 0, 2}, {0, length, 0}, 3, constant(0.5));
  LightSeams seams = sheets.seams(texel);
  const Scene& scene = sheets.loaded().scene;
  for (std::uint32_t h = 0; h < seams.edges.size(); ++h) {
    const std::uint32_t next = h % 3 == 2 ? h - 2 : h + 1;
    const Vec3f a = scene.positions[scene.indices[h]], b = scene.positions[scene.indices[next]];
    const bool below = a.x == 1 && b.x == 1 && h < 2 * 32 * 3;
    if (!below) {
      EXPECT_EQ(seams.edges[h], 0) << h;
    }
  }
  return seams;
}

// Modellers let walls stand on floors, or pass through them, with no vertex in common.
TEST(LightSeams, PartAFloorBelowAWallOfOtherVertices) {
  EXPECT_NEAR(seams_of_floors({1, 0, 0}, 1, 0.001).length, 1, 1e-6);
  EXPECT_NEAR(seams_of_floors({1, -0.1f, -0.7f}, 1.3f, 0.001).length, 1, 1e-6);
  // Only where it stands on most of an edge.
  EXPECT_NEAR(seams_of_floors({1, -0.1f, 0}, 0.7f, 0.001).length, 0.5, 1e-6);
  EXPECT_EQ(seams_of_floors({1, 0, 0}, 0.1f, 0.001).length, 0);
  // A texel aside, the line would still show.
  EXPECT_NEAR(seams_of_floors({1.004f, 0, 0}, 1, 0.005).length, 1, 1e-6);
  EXPECT_EQ(seams_of_floors({1.006f, 0, 0}, 1, 0.005).length, 0);
  EXPECT_EQ(seams_of_floors({1, 0, 0.01f}, 1, 0.005).length, 0);  // hangs above
}

// Both layers continue at every edge, and nothing stands there.
TEST(LightSeams, DoNotShatterThinSheets) {
  Sheets sheet;
  for (int i = 0; i < 8; ++i) {
    sheet.add({float(i), 0, 0}, {1, 0, 0}, {0, 4, 0}, 1, constant(i % 2 ? 0.8 : 0.2))
        .add({float(i), 0, 0}, {0, 4, 0}, {1, 0, 0}, 1, constant(i % 2 ? 0.2 : 0.8));
  }
  const LightSeams seams = sheet.seams();
  EXPECT_NEAR(seams.length, 24, 1e-5);  // the rim
  const Scene& scene = sheet.loaded().scene;
  for (std::uint32_t h = 0; h < seams.edges.size(); ++h) {
    const std::uint32_t next = h % 3 == 2 ? h - 2 : h + 1;
    const Vec3f a = scene.positions[scene.indices[h]], b = scene.positions[scene.indices[next]];
    if (a.x == b.x && a.x > 0 && a.x < 8) {
      EXPECT_EQ(seams.edges[h], 0) << h;
    }
  }
}

// Light that is constant per facet jumps at all edges of a smooth surface.
TEST(LightSeams, DoNotShatterSmoothSurfaces) {
  Sheets tube;
  constexpr int kSides = 32;
  for (int i = 0; i < kSides; ++i) {
    const auto at = [](int k) {
      return Vec3f{float(std::cos(2 * M_PI * k / kSides)), float(std::sin(2 * M_PI * k / kSides)),
                   0};
    };
    const Vec3f a = at(i), b = at((i + 1) % kSides);
    tube.add(a, {b.x - a.x, b.y - a.y, 0}, {0, 0, 1}, 1, constant(i % 2 ? 0.8 : 0.2));
  }
  EXPECT_TRUE(tube.seams().edges.empty());
}

TEST(LightSeams, DoNotDependOnThePlaceOfTheScene) {
  Sheets moved;
  moved.add({-1, 7, 3}, {1, 0, 0}, {0, 1, 0}, 3, constant(0.8))
      .add({0, 7, 3}, {0, 0, 1}, {0, 1, 0}, 3, constant(0.3));
  EXPECT_EQ(moved.seams().edges, corner(3, constant(0.8), constant(0.3)).seams().edges);
}

// A triangle below an edge from (0, 0) to (1, 0) and two above it, whose common vertex hangs on the
// edge. A fourth triangle closes it.
Sheets hanging(double light_there, int closing_first) {
  Sheets sheets;
  LoadedScene loaded = sheets.loaded();
  Scene& scene = loaded.scene;
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0.5f, -1, 0}, {0.5f, 1, 0}, {0.25f, 0, 0}};
  // 0.4 at the place where the vertex hangs.
  for (const double e : {0.3, 0.7, 0.5, 0.5, light_there})
    scene.illumination.push_back(
        {srgb_decode(float(e)), srgb_decode(float(e)), srgb_decode(float(e))});
  scene.indices = {0, 2, 1, 0, 4, 3, 4, 1, 3};
  const std::uint32_t closing[3] = {0, 1, 4};
  for (int k = 0; k < 3; ++k) scene.indices.push_back(closing[(closing_first + k) % 3]);
  scene.triangle_material.assign(4, 0);
  return Sheets(std::move(loaded));
}

TEST(LightSeams, AreEdgesThatAVertexOfOtherLightHangsOn) {
  const float on_edge = srgb_encode(0.75f * srgb_decode(0.3f) + 0.25f * srgb_decode(0.7f));
  for (int first = 0; first < 3; ++first) {
    EXPECT_TRUE(hanging(on_edge + 0.04, first).seams().edges.empty());
    const LightSeams seams = hanging(on_edge + 0.06, first).seams();
    ASSERT_EQ(seams.edges.size(), 12u);
    EXPECT_NEAR(seams.length, 1, 1e-6);
    for (int h = 0; h < 12; ++h)
      EXPECT_EQ(seams.edges[std::size_t(h)] != 0, h == 9 + (3 - first) % 3) << h;
  }
}

}  // namespace
}  // namespace atlas::test
