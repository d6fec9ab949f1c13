#include "libatlas/exporters/gltf_kept/gltf_kept_images.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "libatlas/exporters/writing/scene_writers.h"
#include "libatlas/files/file_extension.h"
#include "libatlas/image/file_kind.h"
#include "libatlas/scene/files/decode_uri.h"
#include "libatlas/scene/gltf/gltf_check.h"

namespace atlas {
namespace fs = std::filesystem;
using nlohmann::json;
namespace {

using Numbers = std::vector<std::optional<std::size_t>>;  // of each image, where it is written

// Returns whether the image is written as the file that it was.
bool is_file(const GltfSource& source, std::size_t image) {
  return image < source.image_files.size() && !source.image_files[image].empty();
}

// Returns the image's number in Scene::textures, or nothing.
std::optional<std::size_t> texture_of(const GltfSource& source, std::size_t image) {
  if (image >= source.image_texture.size() || source.image_texture[image] < 0) return {};
  return std::size_t(source.image_texture[image]);
}

// Returns the extension of a file in a format that is not known: its own, if that is a plain one.
// PNG and JPEG files are known, so others must not be called so.
std::string extension_of(const tinygltf::Image& image) {
  constexpr std::size_t kLongest = 6;
  constexpr const char* kOther = ".bin";
  if (image.uri.empty()) return kOther;
  const std::string own = lower_extension(decode_uri(image.uri));
  const bool plain =
      own.size() > 1 && own.size() <= kLongest &&
      own.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789", 1) == std::string::npos;
  return plain && own != ".png" && own != ".jpg" && own != ".gltf" ? own : kOther;
}

GltfTextures::File file_of(const GltfSource& source, std::size_t number) {
  const std::vector<std::uint8_t>& bytes = source.image_files[number];
  const ExtensionFormat known = extension_format(bytes);
  if (!known.extension.empty())
    return {bytes, std::string(known.extension), std::string(known.mime_type)};
  const json& said = source.document["images"][number].value("mimeType", json());
  return {bytes, extension_of(source.model.images[number]),
          said.is_string() ? said.get<std::string>() : ""};
}

// Gives the images of EXT_lights_image_based their new numbers.
void renumber_light_images(json& document, const Numbers& images) {
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

// Gives a texture the new numbers of its images, its own and those of its extensions. Forms without
// an image are left out. Returns whether any is left.
bool name_images(json& texture, const Numbers& images) {
  bool any = false;
  // Returns whether `holder` names an image that is written.
  const auto renumber = [&](json& holder) {
    const std::int64_t from = integer_at(holder, "source", -1);
    const bool named = from >= 0 && std::size_t(from) < images.size() && images[std::size_t(from)];
    if (named) holder["source"] = *images[std::size_t(from)];
    any |= named;
    return named;
  };
  if (!renumber(texture)) texture.erase("source");
  const auto extensions = texture.find("extensions");
  if (extensions == texture.end() || !extensions->is_object()) return any;
  for (auto at = extensions->begin(); at != extensions->end();) {
    const bool gone = at->is_object() && at->contains("source") && !renumber(*at);
    at = gone ? extensions->erase(at) : std::next(at);
  }
  if (extensions->empty()) texture.erase("extensions");
  return any;
}

}  // namespace

Result<std::vector<bool>> write_kept_images(const GltfSource& source, GltfTextures& textures,
                                            json& document) {
  Numbers images(source.model.images.size());
  json written = json::array();
  for (std::size_t i = 0; i < images.size(); ++i) {
    const auto texture = texture_of(source, i);
    if (!is_file(source, i) && !texture) continue;
    auto image =
        is_file(source, i) ? textures.image(file_of(source, i), i) : textures.image(*texture, i);
    if (!image.ok()) return image.status();
    json entry = document["images"][i];
    for (const char* key : {"uri", "bufferView", "mimeType"}) entry.erase(key);
    entry.update(*image);
    images[i] = written.size();
    written.push_back(std::move(entry));
  }
  document.erase("images");
  if (!written.empty()) document["images"] = std::move(written);
  renumber_light_images(document, images);
  std::vector<bool> usable(source.model.textures.size());
  for (std::size_t t = 0; t < usable.size(); ++t)
    usable[t] = name_images(document["textures"][t], images);
  return usable;
}

std::vector<fs::path> kept_image_paths(const Scene& scene, const fs::path& target) {
  const GltfSource& source = *scene.source;
  std::vector<fs::path> paths;
  for (std::size_t i = 0; i < source.model.images.size(); ++i) {
    if (is_file(source, i))
      paths.push_back(texture_path(target, i, file_of(source, i).extension));
    else if (const auto texture = texture_of(source, i))
      paths.push_back(texture_path(target, i, texture_extension(scene.textures[*texture])));
  }
  return paths;
}

}  // namespace atlas
