// Internal: a scene's triangles as the pieces that formats hold together.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/scene/scene.h"

namespace atlas {

// Triangles of one object and one material, of which all or none have texture coordinates, and all
// or none normals.
struct ScenePart {
  std::uint32_t object = 0, material = 0;
  bool texcoords = false, normals = false;
  std::vector<std::uint32_t> triangles;  // in the scene's order
};

// In the order of the objects, those of one object in the order of its materials.
std::vector<ScenePart> scene_parts(const Scene& scene);

// For each value the index of the first that equals it bit by bit. Files often repeat a value for
// every corner that has it; vertices need not be split there.
std::vector<std::uint32_t> first_equals(std::span<const Vec2f> values);
std::vector<std::uint32_t> first_equals(std::span<const Vec3f> values);

}  // namespace atlas
