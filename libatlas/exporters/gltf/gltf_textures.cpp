#include "libatlas/exporters/gltf/gltf_textures.h"

#include <fmt/format.h>

#include <algorithm>

#include "libatlas/exporters/writing/scene_writers.h"
#include "libatlas/image/file_kind.h"
#include "libatlas/image/image_io.h"
#include "libatlas/scene/files/file_bytes.h"

namespace atlas {
namespace fs = std::filesystem;
using nlohmann::json;
namespace {

// Returns an image of up to four channels, which is what PNG holds. If there are more, the first
// three are the colour.
Image8 colour_of(const Image8& image) {
  if (image.channels <= 4) return image;
  Image8 colour(image.width, image.height, 3);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) std::copy_n(image.at(x, y), 3, colour.at(x, y));
  return colour;
}

}  // namespace

Result<json> GltfTextures::embed(std::size_t index, std::size_t number) {
  const Texture& texture = scene_.textures[index];
  if (!texture.encoded.empty()) {
    const bool png = image_extension(texture.encoded) == ".png";
    const auto* bytes = reinterpret_cast<const char*>(texture.encoded.data());
    return document_.embedded_image({bytes, texture.encoded.size()},
                                    png ? "image/png" : "image/jpeg");
  }
  const fs::path temporary = files_.path_for(texture_path(path_, number, ".png"));
  if (Status s = write_png(temporary, colour_of(texture.image), {}); !s.ok())
    return files_.told_by_target(s);
  const auto bytes = read_file_bytes(temporary);
  files_.discard(temporary);
  if (!bytes.ok() || bytes->size == 0)
    return Status(ErrorCode::io, fmt::format("{}: a texture cannot be read to embed it (is the "
                                             "disk full?)",
                                             path_.string()));
  return document_.embedded_image(bytes->text(), "image/png");
}

Result<json> GltfTextures::write_beside(std::size_t index, std::size_t number) {
  const Texture& texture = scene_.textures[index];
  const fs::path target = texture_path(path_, number, texture_extension(texture));
  const auto* bytes = reinterpret_cast<const char*>(texture.encoded.data());
  Status s = texture.encoded.empty()
                 ? write_png(files_.path_for(target), colour_of(texture.image), {})
                 : files_.write(target, {bytes, texture.encoded.size()});
  if (!s.ok()) return files_.told_by_target(s);
  return GltfDocument::image_beside(target.filename().string());
}

Result<json> GltfTextures::image(const File& file, std::size_t number) {
  const std::string_view bytes(reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size());
  const char* unknown = "application/octet-stream";  // embedded images must have a type
  if (document_.binary())
    return document_.embedded_image(bytes,
                                    file.mime_type.empty() ? unknown : file.mime_type.c_str());
  const fs::path target = texture_path(path_, number, file.extension);
  if (Status s = files_.write(target, bytes); !s.ok()) return s;
  json image = GltfDocument::image_beside(target.filename().string());
  if (!file.mime_type.empty()) image["mimeType"] = file.mime_type;
  return image;
}

fs::path texture_path(const fs::path& target, std::size_t number, std::string_view extension) {
  return target.parent_path() /
         fmt::format("{}_texture{}{}", safe_file_name(target.stem().string()), number, extension);
}

std::string_view texture_extension(const Texture& texture) {
  return texture.encoded.empty() ? ".png" : image_extension(texture.encoded);
}

std::vector<fs::path> scene_texture_paths(const Scene& scene, const fs::path& target) {
  if (scene.source) return kept_image_paths(scene, target);
  std::vector<fs::path> paths;
  for (std::size_t i = 0; i < scene.textures.size(); ++i)
    paths.push_back(texture_path(target, i, texture_extension(scene.textures[i])));
  return paths;
}

}  // namespace atlas
