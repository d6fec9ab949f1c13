// Internal: what of a glTF file is not in a Scene, or not in a format that keeps one. Includes
// tinygltf, so it is for .cpp files only.
#pragma once

#include "libatlas/scene/gltf_file.h"
#include "libatlas/scene/losses.h"

namespace atlas {

// What no scene holds but by Scene::source: all but meshes at rest with names, normals, colours,
// one set of uvs, and materials of a base colour with its texture.
LossCounts gltf_not_read(const tinygltf::Model& model);

// Adds what OBJ cannot hold, which has no uvs and textures beside the new uvs either.
void count_losses(const tinygltf::Model& model, Losses& losses);

}  // namespace atlas
