#include "libatlas/scene/gltf/gltf_source.h"

#include <bit>

#include "libatlas/scene/gltf/gltf_check.h"

namespace atlas {
namespace fs = std::filesystem;

KeptColours kept_colours(const Scene& scene) {
  return scene.source && !scene.source->other_light ? scene.source->colours : KeptColours{};
}

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
  const nlohmann::json& file = source.document;
  const tinygltf::Model& model = source.model;
  bool same = length_at(file, "accessors") == model.accessors.size() &&
              length_at(file, "bufferViews") == model.bufferViews.size() &&
              length_at(file, "images") == model.images.size() &&
              length_at(file, "materials") == model.materials.size() &&
              length_at(file, "meshes") == model.meshes.size() &&
              length_at(file, "nodes") == model.nodes.size() &&
              length_at(file, "textures") == model.textures.size();
  for (std::size_t i = 0; same && i < model.meshes.size(); ++i)
    same = length_at(file["meshes"][i], "primitives") == model.meshes[i].primitives.size();
  if (!same) return malformed_gltf(path, "some of its elements are not as the format has them");
  source.document.erase("buffers");
  for (std::size_t i = 0; i < model.images.size(); ++i) source.document["images"][i].erase("uri");
  return {};
}

}  // namespace atlas
