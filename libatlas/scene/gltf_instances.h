// Internal: EXT_mesh_gpu_instancing, one node that shows its mesh at many places.
#pragma once

#include <glm/mat4x4.hpp>
#include <vector>

#include "libatlas/scene/gltf_file.h"

namespace atlas {

inline constexpr const char* kGltfInstancing = "EXT_mesh_gpu_instancing";

// Where the node shows its mesh, relative to the node: at its own place (one unit matrix), or where
// the extension says. Errors: bad_input.
Result<std::vector<glm::dmat4>> gltf_instances(const tinygltf::Model& model,
                                               const tinygltf::Node& node);

}  // namespace atlas
