// Internal: the images of a glTF file that is written again. Includes tinygltf, so it is for .cpp
// files only.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <vector>

#include "libatlas/exporters/gltf/gltf_textures.h"
#include "libatlas/scene/gltf/gltf_source.h"

namespace atlas {

// Puts the images that are there into the document, and gives the textures and lights of the
// document their numbers. Files of formats that glTF holds only by extensions stay as they are, and
// so do the extensions. Returns for each texture whether it has an image. Errors: io.
Result<std::vector<bool>> write_kept_images(const GltfSource& source, GltfTextures& textures,
                                            nlohmann::json& document);

}  // namespace atlas
