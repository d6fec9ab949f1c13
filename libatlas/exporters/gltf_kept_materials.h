// Internal: the materials, textures and images of a glTF file that is written again. Includes
// tinygltf, so it is for .cpp files only.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "libatlas/exporters/gltf_textures.h"
#include "libatlas/scene/gltf_source.h"
#include "libatlas/scene/losses.h"

namespace atlas {

// They stay in the document as they are, extensions included, but for what names textures or uvs
// that are not there: a reader takes plain factors then, a viewer some texel.
class KeptMaterials {
 public:
  // `document` holds the lists of the source. All must outlive it.
  KeptMaterials(const GltfSource& source, nlohmann::json& document, Losses& losses)
      : source_(source), document_(document), losses_(losses) {}

  // Puts the images into the document and takes what names missing ones out of it. To be called
  // once, first. Errors: io.
  Status write_images(GltfTextures& textures);

  // The number of a material as it is for a primitive that has these sets of uvs; nothing where the
  // source has no such material.
  std::optional<std::size_t> material(int number, const std::set<std::int64_t>& sets);

 private:
  bool name_image(nlohmann::json& texture, const std::vector<std::optional<std::size_t>>& images);

  const GltfSource& source_;
  nlohmann::json& document_;
  Losses& losses_;
  std::map<int, std::set<std::int64_t>> wanted_;  // the sets that each material's textures lie in
  std::map<std::pair<int, std::set<std::int64_t>>, std::size_t> without_;  // by the sets left out
};

}  // namespace atlas
