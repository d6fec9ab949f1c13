// Internal: reads the materials and images of a glTF file.
#pragma once

#include "libatlas/scene/building/scene_builder.h"
#include "libatlas/scene/gltf/gltf_file.h"

namespace atlas {

// Appends the images and materials to the builder, and then one white material for primitives
// without one. Errors: bad_input.
Status add_gltf_materials(const tinygltf::Model& model, SceneBuilder& builder);

}  // namespace atlas
