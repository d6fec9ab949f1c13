// Internal: reads the materials and images of a glTF file.
#pragma once

#include <vector>

#include "libatlas/scene/gltf_file.h"
#include "libatlas/scene/scene_builder.h"

namespace atlas {

// Appends the images and materials to the builder, and then one white material for primitives
// without one. Returns for each material the set of texture coordinates that it uses. Errors:
// bad_input.
Result<std::vector<int>> add_gltf_materials(const tinygltf::Model& model, SceneBuilder& builder);

}  // namespace atlas
