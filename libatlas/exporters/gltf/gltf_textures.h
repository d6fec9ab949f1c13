// Internal: GltfTextures, which writes the textures of a kept scene as images of a glTF document.
#pragma once

#include <cstddef>
#include <filesystem>

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

  // Returns the image of Scene::textures[index], embedded in a .glb or written beside a .gltf. Must
  // be called only once for each texture. Errors: io.
  Result<nlohmann::json> image(std::size_t index) {
    return document_.binary() ? embed(index) : write_beside(index);
  }

 private:
  Result<nlohmann::json> embed(std::size_t index);
  Result<nlohmann::json> write_beside(std::size_t index);

  const Scene& scene_;
  const std::filesystem::path& path_;
  GltfDocument& document_;
  AtomicFiles& files_;
};

}  // namespace atlas
