// Internal: reads EXT_mesh_gpu_instancing, with which one node shows its mesh at many places.
#pragma once

#include <glm/mat4x4.hpp>
#include <vector>

#include "libatlas/scene/gltf/gltf_file.h"

namespace atlas {

inline constexpr const char* kGltfInstancing = "EXT_mesh_gpu_instancing";

// Returns the matrices at which the node shows its mesh, relative to the node: those of the
// extension, or one unit matrix without it. Errors: bad_input.
Result<std::vector<glm::dmat4>> gltf_instances(const tinygltf::Model& model,
                                               const tinygltf::Node& node);

}  // namespace atlas
