// Internal: what all OBJ files here have in common.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "libatlas/core/context.h"
#include "libatlas/exporters/text_output.h"
#include "libatlas/exporters/world.h"

namespace atlas {

// A comment or a name must stay on its line.
std::string one_line(std::string text);

// The title, what else is to be said of the world, and the name of its MTL.
void write_obj_head(TextFile& file, const World& world, const std::filesystem::path& mtl);

// Lines `v` and `vt` of the positions and uvs of a world with these indices; positions carry the
// light of a scene that is kept.
void write_obj_points(TextFile& file, const World& world, std::span<const std::uint32_t> points,
                      const Context& context);
void write_obj_uvs(TextFile& file, const World& world, std::span<const std::uint32_t> uvs,
                   const Context& context);

// Corners as faces name them, 3 a triangle, counted from 0; normals may be empty.
struct ObjCorners {
  std::span<const std::uint32_t> points, uvs, normals = {};
};
void write_obj_faces(TextFile& file, const ObjCorners& corners, const Context& context);

}  // namespace atlas
