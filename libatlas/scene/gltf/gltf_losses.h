// Internal: counts what of a glTF file a Scene, or an OBJ file, does not hold. Includes tinygltf,
// so only .cpp files may include it.
#pragma once

#include "libatlas/scene/building/losses.h"
#include "libatlas/scene/gltf/gltf_file.h"

namespace atlas {

// Counts what a Scene holds only in Scene::source. Its arrays hold meshes at rest with names,
// normals, colours and one set of uvs, and materials of a base colour with its texture.
LossCounts gltf_not_read(const tinygltf::Model& model);

// Adds what an OBJ file cannot hold, including the file's uvs and textures, since the new uvs are
// the only ones there.
void count_losses(const tinygltf::Model& model, Losses& losses);

}  // namespace atlas
