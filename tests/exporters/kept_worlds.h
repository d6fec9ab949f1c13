// Makes worlds that keep a scene (World::scene).
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>

#include "libatlas/exporters/world.h"
#include "libatlas/files/atomic_file.h"
#include "libatlas/scene/reader.h"

namespace atlas::test {

// Returns four triangles: a square and its back, of two objects and two materials.
inline Scene small_scene() {
  Scene scene;
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  scene.indices = {0, 1, 2, 0, 2, 3, 2, 1, 0, 3, 2, 0};
  scene.texcoords = {{0, 0}, {2, 0}, {2, -2}, {0, -2}};
  scene.texcoord_indices = {0, 1, 2, 0, 2, 3, 2, 1, 0, 3, 2, 0};
  scene.normals = {{0, 0, 1}, {0, 0, -1}};
  scene.normal_indices = {0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1};
  scene.materials = {{"paint", {0.5f, 0.25f, 1}, -1}, {"wood # 2", {1, 1, 1}, -1}};
  scene.triangle_material = {0, 1, 0, 0};
  scene.object_names = {"front", "back"};
  scene.triangle_object = {0, 0, 1, 1};
  return scene;
}

// Returns the scene with new uvs, a different one for each corner. `scene` must outlive it.
inline World world_of(const Scene& scene) {
  World world;
  world.positions = scene.positions;
  world.origin = scene.origin;
  world.scene = &scene;
  Page page;
  page.indices = scene.indices;
  for (std::size_t k = 0; k < scene.indices.size(); ++k) {
    page.uv_indices.push_back(std::uint32_t(k));
    world.uvs.push_back({float(k) / 64, 1 - float(k) / 32});
  }
  world.pages = {page};
  return world;
}

inline Result<WorldFile> write_kept(const World& world, const std::filesystem::path& path) {
  AtomicFiles files;
  auto written = write_world(world, path, files, {});
  if (!written.ok()) return written;
  const Status committed = files.commit();
  return committed.ok() ? written : Result<WorldFile>(committed);
}

// Reads `input` and writes it to `output` with new uvs. An error fails the test.
inline WorldFile read_and_keep(const std::filesystem::path& input,
                               const std::filesystem::path& output, const ReadOptions& options) {
  const auto loaded = read_scene(input, options, {});
  EXPECT_TRUE(loaded.ok()) << loaded.status().message();
  if (!loaded.ok()) return {};
  const World world = world_of(loaded->scene);
  const auto written = write_kept(world, output);
  EXPECT_TRUE(written.ok()) << written.status().message();
  return written.ok() ? *written : WorldFile{};
}

}  // namespace atlas::test
