// Tests the visual comparison on rooms with known results.
#include "tests/support/fidelity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "libatlas/image/image_io.h"
#include "tests/support/program_output.h"
#include "tests/support/shapes.h"
#include "tests/support/shared_data.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

double encode(double c) {
  return c <= 0.0031308 ? c * 12.92 : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
}

// Returns the inside of a box with one surface per wall, wall k lit with (k + 1) / 10.
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
      room.light.emplace_back(0.1f * float(wall + 1));
    }
    room.triangles.push_back({first, first + 1, first + 2});
    room.triangle_texcoords.push_back(
        {WorldMesh::kNoTexcoord, WorldMesh::kNoTexcoord, WorldMesh::kNoTexcoord});
    room.triangle_surface.push_back(wall);
  }
  return room;
}

// Returns the export of lit_room: one page of a single colour per wall, with 0.6 as display white.
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
  EXPECT_GT(f.psnr, 53);  // uniform 8-bit rounding gives 58.9 dB; these six values at least 53
  EXPECT_LT(f.p999, 1 / 255.0);
  EXPECT_EQ(f.bad8, 0);
  EXPECT_EQ(f.miss, 0);
  EXPECT_NEAR(f.scale, 1 / 0.6, 1 / 0.6 * 0.01);
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
  // The mean square is that of the wrong pixels, 40/255 (less what the fitted exposure
  // compensates).
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

namespace fs = std::filesystem;

// Writes the mesh as files: an OBJ, its MTL, and the images as PNG.
void write_files(const WorldMesh& mesh, const fs::path& obj) {
  const std::string stem = obj.stem().string();
  std::ofstream out(obj), mtl(fs::path(obj).replace_extension(".mtl"));
  out << "mtllib " << stem << ".mtl\n";
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3 p = mesh.positions[i], e = mesh.light[i];
    out << "v " << p.x << " " << p.y << " " << p.z << " " << e.x << " " << e.y << " " << e.z
        << "\n";
  }
  for (const glm::vec2& t : mesh.texcoords) out << "vt " << t.x << " " << t.y << "\n";
  for (std::size_t s = 0; s < mesh.surfaces.size(); ++s) {
    mtl << "newmtl s" << s << "\nKd 1 1 1\n";
    if (mesh.surfaces[s].image < 0) continue;
    const std::string name = stem + std::to_string(s) + ".png";
    mtl << "map_Kd " << name << "\n";
    ASSERT_TRUE(write_png(obj.parent_path() / name, mesh.images[mesh.surfaces[s].image], {}).ok());
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    out << "usemtl s" << mesh.triangle_surface[t] << "\nf";
    for (std::uint32_t v : mesh.triangles[t])
      out << " " << v + 1 << (mesh.texcoords.empty() ? "" : "/1");
    out << "\n";
  }
}

// The cameras of both programs differ, so the shares of pixels agree only as well as 64 views of
// one room do.
TEST(Fidelity, AgreesWithTheSharedMeasuringProgram) {
  const auto shared = shared_data("../tools/fidelity.cpp");
  if (!shared) GTEST_SKIP() << lacks("a shared program beside it to compare with");
  const fs::path source = *shared;
  const TempFolder folder;
  const std::string program = (folder / "fidelity").string();
  output_of("c++ -O1 -std=c++17 -w -o " + program + " " + source.string() +
            " -lembree3 -lOpenImageIO -lOpenImageIO_Util 2>/dev/null");
  if (!fs::exists(program))
    GTEST_SKIP() << "the shared program does not compile here (it wants Embree 3)";
  const WorldMesh room = lit_room();
  WorldMesh world = exported_room(room);
  for (std::uint8_t& v : world.images[2].texels) v = std::uint8_t(v + 40);
  write_files(room, folder / "room.obj");
  write_files(world, folder / "world.obj");
  const std::string json = output_of(program + " " + (folder / "room.obj").string() + " " +
                                     (folder / "world.obj").string() + " --cams 64 --size 96 64");
  const auto read_room = read_world(folder / "room.obj"),
             read_back = read_world(folder / "world.obj");
  ASSERT_TRUE(read_room.ok() && read_back.ok());
  const Fidelity f = compare_views(*read_room, *read_back, {64, 96, 64});
  EXPECT_NEAR(f.psnr, json_field(json, "psnr"), 1.5);
  EXPECT_NEAR(f.bad8, json_field(json, "bad8"), 0.05);
  EXPECT_NEAR(f.scale, json_field(json, "scale"), 0.02 * f.scale);
  EXPECT_NEAR(f.white, json_field(json, "white"), 0.03);
  EXPECT_EQ(f.miss, 0);
  EXPECT_EQ(json_field(json, "miss"), 0);
  EXPECT_EQ(f.triangles_in, std::size_t(json_field(json, "tris_in")));
}

}  // namespace
}  // namespace atlas::test
