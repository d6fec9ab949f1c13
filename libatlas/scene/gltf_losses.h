// Internal: what of a glTF file is not in a Scene, or not in a format that keeps one. Includes
// tinygltf, so it is for .cpp files only.
#pragma once

#include "libatlas/scene/gltf_file.h"
#include "libatlas/scene/losses.h"

namespace atlas {

// Returns what a Scene holds only by Scene::source. Its arrays hold meshes at rest with names,
// normals, colours, one set of uvs, and materials of a base colour with its texture.
LossCounts gltf_not_read(const tinygltf::Model& model);

// Adds what OBJ cannot hold, uvs and textures among it, since the new uvs are the only ones.
void count_losses(const tinygltf::Model& model, Losses& losses);

}  // namespace atlas
