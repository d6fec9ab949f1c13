#include "libatlas/exporters/gltf_kept/gltf_kept_materials.h"

#include <algorithm>
#include <functional>

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

// Returns the images that a texture names: its own first, then those of its extensions.
std::vector<std::size_t> images_of(const json& texture, std::size_t count) {
  std::vector<std::size_t> images;
  const auto add = [&](const json& holder) {
    const std::int64_t source = integer_at(holder, "source", -1);
    if (source >= 0 && std::size_t(source) < count) images.push_back(std::size_t(source));
  };
  add(texture);
  if (const auto extensions = texture.find("extensions");
      extensions != texture.end() && extensions->is_object())
    for (const json& extension : *extensions)
      if (extension.is_object()) add(extension);
  return images;
}

// Gives the images of EXT_lights_image_based their new numbers.
void renumber_light_images(json& document, const std::vector<std::optional<std::size_t>>& images) {
  const json* found = extension_at(document, "EXT_lights_image_based");
  if (found == nullptr || !found->is_object() || !found->contains("lights")) return;
  const std::function<void(json&)> renumber = [&](json& part) {
    if (part.is_array()) std::for_each(part.begin(), part.end(), renumber);
    if (!part.is_number_integer()) return;
    const auto number = part.get<std::int64_t>();
    if (number >= 0 && std::size_t(number) < images.size() && images[std::size_t(number)])
      part = *images[std::size_t(number)];
  };
  for (json& light : document["extensions"]["EXT_lights_image_based"]["lights"])
    if (light.is_object() && light.contains("specularImages")) renumber(light["specularImages"]);
}

}  // namespace

// Returns which images are written: those that can be read, except those that textures name only as
// another form of the image that is written for them.
std::vector<bool> KeptMaterials::wanted_images() const {
  std::vector<bool> wanted(source_.model.images.size()), named(wanted.size());
  const auto readable = [&](std::size_t i) {
    return i < source_.image_texture.size() && source_.image_texture[i] >= 0;
  };
  for (std::size_t t = 0; t < source_.model.textures.size(); ++t) {
    const auto images = images_of(document_["textures"][t], wanted.size());
    for (const std::size_t i : images) named[i] = true;
    const auto first = std::find_if(images.begin(), images.end(), readable);
    if (first != images.end()) wanted[*first] = true;
  }
  for (std::size_t i = 0; i < wanted.size(); ++i)
    wanted[i] = readable(i) && (wanted[i] || !named[i]);
  return wanted;
}

// Gives a texture the new number of its image, and returns whether it has one. Extensions refer to
// images in formats that glTF itself does not have; these images have become PNG by now, so the
// texture itself refers to them.
bool KeptMaterials::name_image(json& texture,
                               const std::vector<std::optional<std::size_t>>& images) {
  std::optional<std::size_t> named;
  for (const std::size_t i : images_of(texture, images.size()))
    if (!named) named = images[i];
  texture.erase("source");
  if (const auto extensions = texture.find("extensions");
      extensions != texture.end() && extensions->is_object()) {
    for (auto at = extensions->begin(); at != extensions->end();) {
      const bool names = at->is_object() && at->contains("source");
      at = names ? extensions->erase(at) : std::next(at);
    }
    if (extensions->empty()) texture.erase("extensions");
  }
  if (named) texture["source"] = *named;
  return named.has_value();
}

Status KeptMaterials::write_images(GltfTextures& textures) {
  std::vector<std::optional<std::size_t>> images(source_.model.images.size());
  const std::vector<bool> wanted = wanted_images();
  json written = json::array();
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (!wanted[i]) continue;
    auto image = textures.image(std::size_t(source_.image_texture[i]));
    if (!image.ok()) return image.status();
    json entry = document_["images"][i];
    for (const char* key : {"uri", "bufferView", "mimeType"}) entry.erase(key);
    entry.update(*image);
    images[i] = written.size();
    written.push_back(std::move(entry));
  }
  document_.erase("images");
  if (!written.empty()) document_["images"] = std::move(written);
  renumber_light_images(document_, images);
  std::vector<bool> usable(source_.model.textures.size());
  for (std::size_t t = 0; t < usable.size(); ++t)
    usable[t] = name_image(document_["textures"][t], images);
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
