// Internal: GltfTextures, which writes the textures of a kept scene as images of a glTF document.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "libatlas/exporters/gltf/gltf_document.h"
#include "libatlas/scene/scene.h"

namespace atlas {

class GltfTextures {
 public:
  // `target` is the .gltf or .glb; files beside it are written through `files`. All arguments must
  // outlive the object.
  GltfTextures(const Scene& scene, const std::filesystem::path& target, GltfDocument& document,
               AtomicFiles& files)
      : scene_(scene), path_(target), document_(document), files_(files) {}

  // Each returns an image, embedded in a .glb or written beside a .gltf, where its file is called
  // by `number` (texture_path()). Must be called only once for each number. Errors: io.
  //
  // The image of Scene::textures[index].
  Result<nlohmann::json> image(std::size_t index, std::size_t number) {
    return document_.binary() ? embed(index, number) : write_beside(index, number);
  }
  // An image file of any format.
  struct File {
    std::span<const std::uint8_t> bytes;
    std::string extension, mime_type;
  };
  Result<nlohmann::json> image(const File& file, std::size_t number);

 private:
  Result<nlohmann::json> embed(std::size_t index, std::size_t number);
  Result<nlohmann::json> write_beside(std::size_t index, std::size_t number);

  const Scene& scene_;
  const std::filesystem::path& path_;
  GltfDocument& document_;
  AtomicFiles& files_;
};

// Returns the file that an image becomes beside the .gltf `target`. `extension` begins with a dot.
std::filesystem::path texture_path(const std::filesystem::path& target, std::size_t number,
                                   std::string_view extension);

// Returns the extension of the file that a texture becomes.
std::string_view texture_extension(const Texture& texture);

}  // namespace atlas
