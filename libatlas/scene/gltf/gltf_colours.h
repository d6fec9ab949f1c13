// Internal: light and colours of a glTF file's vertices. Includes tinygltf, so it is for .cpp files
// only.
#pragma once

#include <cstddef>

#include "libatlas/core/status.h"
#include "libatlas/scene/building/scene_builder.h"
#include "libatlas/scene/gltf/gltf_file.h"
#include "libatlas/scene/gltf/gltf_kept_colours.h"

namespace atlas {

// The builder's vertices that are a primitive's.
struct GltfVertexRange {
  std::size_t first = 0, count = 0;
};

// Returns what the file's COLOR_0 holds. Colours that cannot be read are within one.
KeptColours find_gltf_colours(const tinygltf::Model& model);

// Takes the vertices' light, _ILLUMINANCE or else COLOR_0, which is NaN where there is none, and
// alpha of COLOR_0 if wants_rest is set. Returns whether there is light. Error: bad_input.
Result<bool> add_gltf_light(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                            const GltfVertexRange& vertices, SceneBuilder& builder);

// Takes COLOR_0, by which the format multiplies base colours, as SceneBuilder::unlit_colours.
// Colours that cannot be read are ignored.
void add_gltf_unlit_colours(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                            const GltfVertexRange& vertices, SceneBuilder& builder);

}  // namespace atlas
