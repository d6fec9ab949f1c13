// Internal: the parts that all OBJ files have in common.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "libatlas/core/context.h"
#include "libatlas/exporters/world.h"
#include "libatlas/exporters/writing/text_output.h"

namespace atlas {

// Writes the title and the information of the world as comments, and the name of its MTL.
void write_obj_head(TextFile& file, const World& world, const std::filesystem::path& mtl);

// Write the lines `v` and `vt` of the world's positions and uvs with these indices. If a scene is
// kept, positions carry its light.
void write_obj_points(TextFile& file, const World& world, std::span<const std::uint32_t> points,
                      const Context& context);
void write_obj_uvs(TextFile& file, const World& world, std::span<const std::uint32_t> uvs,
                   const Context& context);

// Corners as faces refer to them, counted from 0; `normals` may be empty. `sizes`: the corners of
// each face; empty: triangles.
struct ObjCorners {
  std::span<const std::uint32_t> points, uvs, normals = {}, sizes = {};
};
void write_obj_faces(TextFile& file, const ObjCorners& corners, const Context& context);

}  // namespace atlas
