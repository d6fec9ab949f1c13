#include "libatlas/exporters/gltf_kept/gltf_kept_materials.h"

#include <functional>

#include "libatlas/exporters/gltf_kept/gltf_kept_images.h"
#include "libatlas/scene/gltf/gltf_check.h"

namespace atlas {
using nlohmann::json;
namespace {

// Removes the textures for which `stays` is false from a material, or from a part of one, and
// returns their number. The keys of all textures, including those of extensions, end in "Texture".
std::size_t strip_textures(json& part, const std::function<bool(const json&)>& stays) {
  std::size_t stripped = 0;
  for (auto at = part.begin(); at != part.end();) {
    if (!at->is_object() || at.key() == "extras") {
      ++at;
      continue;
    }
    const bool texture = at.key().ends_with("Texture") && at->contains("index");
    if (texture && !stays(*at)) {
      at = part.erase(at);
      ++stripped;
      continue;
    }
    if (!texture) stripped += strip_textures(*at, stays);
    ++at;
  }
  return stripped;
}

// Returns the uv set that a texture uses. KHR_texture_transform may override the texture's own.
std::int64_t set_of(const json& texture) {
  const std::int64_t own = integer_at(texture, "texCoord", 0);
  const auto extensions = texture.find("extensions");
  if (extensions == texture.end() || !extensions->is_object()) return own;
  const auto transform = extensions->find("KHR_texture_transform");
  return transform != extensions->end() && transform->is_object()
             ? integer_at(*transform, "texCoord", own)
             : own;
}

}  // namespace

Status KeptMaterials::write_images(GltfTextures& textures) {
  const auto written = write_kept_images(source_, textures, document_);
  if (!written.ok()) return written.status();
  const std::vector<bool>& usable = *written;
  for (std::size_t m = 0; m < source_.model.materials.size(); ++m) {
    const auto stays = [&](const json& texture) {
      const std::int64_t index = integer_at(texture, "index", -1);
      if (index < 0 || std::size_t(index) >= usable.size() || !usable[std::size_t(index)])
        return false;
      wanted_[int(m)].insert(set_of(texture));
      return true;
    };
    losses_.add("textures of materials (no image that can be read)",
                strip_textures(document_["materials"][m], stays));
  }
  return {};
}

std::optional<std::size_t> KeptMaterials::material(int number, const std::set<std::int64_t>& sets) {
  if (number < 0 || std::size_t(number) >= source_.model.materials.size()) return {};
  std::set<std::int64_t> missing = wanted_[number];
  for (const std::int64_t set : sets) missing.erase(set);
  if (missing.empty()) return std::size_t(number);
  json& materials = document_["materials"];
  const auto [at, is_new] = without_.try_emplace({number, missing}, materials.size());
  if (!is_new) return at->second;
  json copy = materials[std::size_t(number)];
  losses_.add("textures of materials (no uvs for them in their primitives)",
              strip_textures(copy, [&](const json& t) { return !missing.contains(set_of(t)); }));
  materials.push_back(std::move(copy));
  return at->second;
}

}  // namespace atlas
