// Packed glTF worlds, read back with the library's own reader.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "libatlas/image/image_io.h"
#include "libatlas/scene/reader.h"
#include "tests/exporters/worlds.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::TempFolder;
using test::wavy_world;

// A corner as whole numbers: of steps of the positions, and of 65535ths of the uvs.
using PackedCorner = std::array<std::int64_t, 5>;
using PackedTriangle = std::array<PackedCorner, 3>;

PackedCorner corner(const Vec3f& p, const Vec2f& uv, double step) {
  const auto whole = [](double v) { return std::int64_t(std::llround(v)); };
  return {whole(p.x / step), whole(p.y / step), whole(p.z / step), whole(65535 * uv.x),
          whole(65535 * (1 - double(uv.y)))};
}

// Begins with the least corner, and keeps the orientation.
void add(std::vector<PackedTriangle>& triangles, PackedTriangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  triangles.push_back(t);
}

std::vector<PackedTriangle> triangles_of(const World& world, double step) {
  std::vector<PackedTriangle> result;
  for (const Page& page : world.pages)
    for (std::size_t t = 0; t < page.indices.size(); t += 3) {
      PackedTriangle triangle;
      for (std::size_t k = 0; k < 3; ++k)
        triangle[k] =
            corner(world.positions[page.indices[t + k]], world.uvs[page.uv_indices[t + k]], step);
      add(result, triangle);
    }
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<PackedTriangle> triangles_of(const Scene& scene, double step) {
  std::vector<PackedTriangle> result;
  for (std::size_t t = 0; t < scene.indices.size(); t += 3) {
    PackedTriangle triangle;
    for (std::size_t k = 0; k < 3; ++k)
      triangle[k] = corner(scene.positions[scene.indices[t + k]],
                           scene.texcoords[scene.texcoord_indices[t + k]], step);
    add(result, triangle);
  }
  std::sort(result.begin(), result.end());
  return result;
}

std::uintmax_t written_bytes(const World& world, const std::filesystem::path& path) {
  for (const Page& page : world.pages)
    EXPECT_TRUE(write_png(path.parent_path() / page.image, Image8(8, 8, 3, 50), {}).ok());
  AtomicFiles files;
  const auto written = write_gltf(world, path, files, {});
  EXPECT_TRUE(written.ok()) << written.status().message();
  EXPECT_TRUE(files.commit().ok());
  return std::uintmax_t(written->bytes);
}

// Positions on a grid of 65535 steps, the last vertex of which is the far corner: they are read
// back as they were.
World world_on_a_grid(double step) {
  World world = wavy_world(60, 3);
  for (Vec3f& p : world.positions) {
    const auto on_grid = [&](float v) { return float(step * std::round(double(v) / step)); };
    p = {on_grid(p.x), on_grid(p.y), on_grid(p.z / 1000)};
  }
  world.positions[0] = {0, 0, float(-32768 * step)};
  world.positions[1] = {1, 0, float(32767 * step)};
  return world;
}

TEST(PackedGltf, ReadsBackOnTheGrid) {
  const TempFolder folder;
  constexpr double kStep = 1.0 / 1024;
  World world = world_on_a_grid(kStep);
  for (const char* name : {"packed.gltf", "packed.glb"}) {
    for (Page& page : world.pages) page.image_source = folder / page.image;
    world.compress_slip = kStep;
    written_bytes(world, folder / name);
    const auto loaded = read_scene(folder / name, {}, {});
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    EXPECT_TRUE(loaded->defects.empty()) << loaded->defects.lines().front();
    EXPECT_EQ(loaded->scene.textures.size(), 3u);
    EXPECT_EQ(triangles_of(loaded->scene, kStep), triangles_of(world, kStep)) << name;
  }
}

// Every page's corners lie on one grid, so no crack opens between pages.
TEST(PackedGltf, PositionsStayEqualAcrossPages) {
  const TempFolder folder;
  World world = wavy_world(40, 4);
  world.compress_slip = 1;
  written_bytes(world, folder / "packed.gltf");
  const auto loaded = read_scene(folder / "packed.gltf", {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  std::vector<std::array<float, 3>> before, after;
  for (const Vec3f& p : world.positions) before.push_back({p.x, p.y, p.z});
  for (const Vec3f& p : loaded->scene.positions) after.push_back({p.x, p.y, p.z});
  const auto distinct = [](auto& list) {
    std::sort(list.begin(), list.end());
    return std::size_t(std::unique(list.begin(), list.end()) - list.begin());
  };
  EXPECT_LE(distinct(after), distinct(before));
}

TEST(PackedGltf, PositionsStayFloatsWhereAGridWouldMoveThemTooFar) {
  const TempFolder folder;
  World world = wavy_world(40, 2);
  world.compress_slip = 1e-3;  // the sheet is 2e4 high
  written_bytes(world, folder / "packed.gltf");
  const auto loaded = read_scene(folder / "packed.gltf", {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(triangles_of(loaded->scene, 1e-12), triangles_of(world, 1e-12));
}

TEST(PackedGltf, TakesLessThanHalf) {
  const TempFolder folder;
  World world = world_on_a_grid(1.0 / 1024);
  const auto plain = written_bytes(world, folder / "plain.gltf");
  world.compress_slip = 1;
  const auto packed = written_bytes(world, folder / "packed.gltf");
  EXPECT_LT(2 * packed, plain);
}

// Plain uvs were rounded so that no texel is drawn for two charts.
TEST(PackedGltf, UvsWithoutImagesStayAsTheyAre) {
  const TempFolder folder;
  World world = wavy_world(20, 1);
  world.pages[0].image.clear();
  world.uvs[5] = {0.123456789f, 0.3333333f};
  world.compress_slip = 1;
  AtomicFiles files;
  ASSERT_TRUE(write_gltf(world, folder / "plain.glb", files, {}).ok());
  ASSERT_TRUE(files.commit().ok());
  const auto loaded = read_scene(folder / "plain.glb", {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const auto& uvs = loaded->scene.texcoords;
  EXPECT_TRUE(
      std::any_of(uvs.begin(), uvs.end(), [](const Vec2f& uv) { return uv.x == 0.123456789f; }));
}

}  // namespace
}  // namespace atlas
