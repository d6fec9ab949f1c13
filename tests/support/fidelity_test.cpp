// The visual judge on rooms whose answer is known.
#include "tests/support/fidelity.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/shapes.h"

namespace atlas::test {
namespace {

double encode(double c) {
  return c <= 0.0031308 ? c * 12.92 : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
}

// The inside of a box, one surface a wall, wall k lit with (k + 1) * 100.
WorldMesh lit_room() {
  const Shape shape = box(1, {4, 3, 2.5});
  WorldMesh room;
  for (std::size_t t = 0; t < shape.indices.size(); t += 3) {
    const auto wall = std::uint32_t(t / 6);
    if (t % 6 == 0) room.surfaces.emplace_back();
    const auto first = std::uint32_t(room.positions.size());
    for (int k = 0; k < 3; ++k) {
      const Vec3f p = shape.positions[shape.indices[t + k]];
      room.positions.emplace_back(p.x, p.y, p.z);
      room.light.emplace_back(100.0f * float(wall + 1));
    }
    room.triangles.push_back({first, first + 1, first + 2});
    room.triangle_texcoords.push_back(
        {WorldMesh::kNoTexcoord, WorldMesh::kNoTexcoord, WorldMesh::kNoTexcoord});
    room.triangle_surface.push_back(wall);
  }
  return room;
}

// The export of lit_room: one page a wall, of one colour; 600 is display white.
WorldMesh exported_room(const WorldMesh& room) {
  WorldMesh world = room;
  world.texcoords.assign(1, glm::vec2(0.5f));
  for (auto& t : world.triangle_texcoords) t = {0, 0, 0};
  for (std::size_t wall = 0; wall < world.surfaces.size(); ++wall) {
    world.surfaces[wall].image = int(wall);
    world.images.emplace_back(2, 2, 3,
                              std::uint8_t(std::lround(255 * encode(double(wall + 1) / 6))));
  }
  for (auto& e : world.light) e = glm::vec3(1);
  return world;
}

constexpr ViewOptions kSmall{6, 96, 64};

TEST(Fidelity, AFaithfulWorldDiffersByRoundingOnly) {
  const WorldMesh room = lit_room();
  const Fidelity f = compare_views(room, exported_room(room), kSmall);
  EXPECT_EQ(f.cameras, 6u);
  EXPECT_GT(f.psnr, 53);  // 8-bit rounding, uniform: 58.9 dB; the six values here: at least this
  EXPECT_LT(f.p999, 1 / 255.0);
  EXPECT_EQ(f.bad8, 0);
  EXPECT_EQ(f.miss, 0);
  EXPECT_NEAR(f.scale, 1 / 600.0, 1 / 600.0 * 0.01);
  EXPECT_GT(f.white, 0.6);
  EXPECT_LT(f.white, 1.02);
}

TEST(Fidelity, OneWrongWallIsItsShareOfThePicture) {
  const WorldMesh room = lit_room();
  WorldMesh world = exported_room(room);
  for (std::uint8_t& v : world.images[2].texels) v = std::uint8_t(v + 40);
  const Fidelity f = compare_views(room, world, kSmall);
  EXPECT_GT(f.bad8, 0.02);
  EXPECT_LT(f.bad8, 0.6);
  // The mean square is that of the wrong pixels, 40/255 (less what the fitted exposure takes back).
  const double expected = -10 * std::log10(f.bad8 * std::pow(40 / 255.0, 2));
  EXPECT_NEAR(f.psnr, expected, 1.5);
}

TEST(Fidelity, AHoleIsMissed) {
  const WorldMesh room = lit_room();
  WorldMesh world = exported_room(room);
  world.triangles.pop_back();
  world.triangle_texcoords.pop_back();
  world.triangle_surface.pop_back();
  const Fidelity f = compare_views(room, world, kSmall);
  EXPECT_GT(f.miss, 0.005);
  EXPECT_LT(f.miss, 0.5);
}

TEST(Fidelity, ADarkExportIsToldByItsWhite) {
  const WorldMesh room = lit_room();
  WorldMesh world = exported_room(room);
  for (Image8& image : world.images)
    for (std::uint8_t& v : image.texels) v = std::uint8_t(v / 2);
  EXPECT_LT(compare_views(room, world, kSmall).white, 0.35);
}

}  // namespace
}  // namespace atlas::test
