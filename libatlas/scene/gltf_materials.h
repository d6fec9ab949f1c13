// Internal: the materials and images of a glTF file.
#pragma once

#include <vector>

#include "libatlas/scene/gltf_file.h"
#include "libatlas/scene/scene_builder.h"

namespace atlas {

// Appends them to the builder, and one material more, for primitives without one. Returns for each
// material which set of texture coordinates it asks for. Errors: bad_input.
Result<std::vector<int>> add_gltf_materials(const tinygltf::Model& model, SceneBuilder& builder);

}  // namespace atlas
