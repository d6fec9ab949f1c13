#include "libatlas/scene/gltf_source.h"

#include <bit>

#include "libatlas/scene/gltf_check.h"

namespace atlas {
namespace fs = std::filesystem;

std::uint64_t positions_mark(const Scene& scene) {
  std::uint64_t mark = scene.positions.size();
  const auto mix = [&mark](std::uint64_t bits) {
    mark = (mark ^ bits) * 0x9e3779b97f4a7c15u;  // odd, so that no difference is lost
    mark ^= mark >> 32;
  };
  for (const double c : {scene.origin.x, scene.origin.y, scene.origin.z})
    mix(std::bit_cast<std::uint64_t>(c));
  for (const Vec3f& p : scene.positions)
    for (const float c : {p.x, p.y, p.z}) mix(std::bit_cast<std::uint32_t>(c));
  return mark;
}

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
