// Internal: a scene's triangles, grouped into the parts that file formats hold together.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/scene/scene.h"

namespace atlas {

// Triangles of one object and one material, on one page. Either all or none of them have texture
// coordinates, and either all or none have normals.
struct ScenePart {
  std::uint32_t object = 0, material = 0;
  bool texcoords = false, normals = false;
  std::uint32_t page = 0;
  std::vector<std::uint32_t> triangles;  // in the scene's order
};

// Returns the parts in the order of the objects, and those of one object in the order of its
// materials. `triangle_page` has one value per triangle, or none if all are on one page.
std::vector<ScenePart> scene_parts(const Scene& scene,
                                   std::span<const std::uint32_t> triangle_page = {});

// Returns for each value the index of the first value that equals it bit by bit. Files often repeat
// a value for every corner that uses it; vertices need not be split there.
std::vector<std::uint32_t> first_equals(std::span<const Vec2f> values);
std::vector<std::uint32_t> first_equals(std::span<const Vec3f> values);

}  // namespace atlas
