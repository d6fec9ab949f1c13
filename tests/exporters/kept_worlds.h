// Worlds that keep a scene (World::scene).
#pragma once

#include <cstdint>
#include <filesystem>

#include "libatlas/core/atomic_file.h"
#include "libatlas/exporters/world.h"
#include "libatlas/scene/scene.h"

namespace atlas::test {

// The scene with new uvs, one a corner, so that each can be told from the others. `scene` must
// outlive it.
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

}  // namespace atlas::test
