// Internal: KeptMaterials, the materials, textures and images of a glTF file that is written again.
// Includes tinygltf, so it is for .cpp files only.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "libatlas/exporters/gltf/gltf_textures.h"
#include "libatlas/scene/building/losses.h"
#include "libatlas/scene/gltf/gltf_source.h"

namespace atlas {

// Materials stay in the document as they are, including their extensions, but references to missing
// textures or uv sets are removed: with them, a reader would use the plain factors, while a viewer
// would show some texel.
class KeptMaterials {
 public:
  // `document` holds the lists of the source. All arguments must outlive the object.
  KeptMaterials(const GltfSource& source, nlohmann::json& document, Losses& losses)
      : source_(source), document_(document), losses_(losses) {}

  // Puts the images into the document, and removes references to missing ones. Must be called once,
  // before material(). Errors: io.
  Status write_images(GltfTextures& textures);

  // Returns the number of a material for a primitive that has these uv sets; if the material's
  // textures need others, this is a copy of it without these textures. Returns nothing if the
  // source has no such material.
  std::optional<std::size_t> material(int number, const std::set<std::int64_t>& sets);

 private:
  const GltfSource& source_;
  nlohmann::json& document_;
  Losses& losses_;
  std::map<int, std::set<std::int64_t>> wanted_;  // the uv sets that each material's textures use
  // Copies without some textures, by the material and the missing uv sets.
  std::map<std::pair<int, std::set<std::int64_t>>, std::size_t> without_;
};

}  // namespace atlas
