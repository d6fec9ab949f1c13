#include "libatlas/scene/gltf_source.h"

#include "libatlas/scene/gltf_check.h"

namespace atlas {
namespace fs = std::filesystem;

Status take_data_out(const fs::path& path, GltfSource& source) {
  const auto length = [](const nlohmann::json& of, const char* list) {
    const auto at = of.find(list);
    return at == of.end() ? std::size_t{0} : at->size();
  };
  const nlohmann::json& file = source.document;
  const tinygltf::Model& model = source.model;
  bool same = length(file, "accessors") == model.accessors.size() &&
              length(file, "bufferViews") == model.bufferViews.size() &&
              length(file, "images") == model.images.size() &&
              length(file, "materials") == model.materials.size() &&
              length(file, "meshes") == model.meshes.size() &&
              length(file, "nodes") == model.nodes.size() &&
              length(file, "textures") == model.textures.size();
  for (std::size_t i = 0; same && i < model.meshes.size(); ++i)
    same = length(file["meshes"][i], "primitives") == model.meshes[i].primitives.size();
  if (!same) return malformed_gltf(path, "some of its elements are not as the format has them");
  source.document.erase("buffers");
  for (std::size_t i = 0; i < model.images.size(); ++i) source.document["images"][i].erase("uri");
  return {};
}

}  // namespace atlas
