// Writes the lit cabin to files: OBJ with its MTL and textures, PLY, GLB.
#pragma once

#include <filesystem>

#include "examples/cabin/cabin_mesh.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"

namespace cabin {

// Checks whether write_scene() can write there; to be called before long work. Errors: bad_option,
// io.
atlas::Status check_scene_path(const std::filesystem::path& path);

// Writes a file by the extension of `path`: .obj (v x y z r g b, plus MTL and PNG textures beside
// it), .ply (binary, colours as floats, without texture coordinates), .glb (attribute _ILLUMINANCE,
// textures beside it). Illuminance is linear RGB in lux, not yet multiplied by the reflectance.
// Other errors: io, cancelled (no file is left then).
atlas::Status write_scene(const std::filesystem::path& path, const Mesh& mesh, bool y_up,
                          const atlas::Context& context = {});

}  // namespace cabin
