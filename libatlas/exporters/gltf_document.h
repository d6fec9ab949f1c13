// Internal: a glTF document in the making, its binary data, and the files that it becomes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "libatlas/core/atomic_file.h"
#include "libatlas/core/status.h"
#include "libatlas/exporters/world.h"

namespace atlas {

class GltfDocument {
 public:
  // `binary`: for a .glb. Begins with the world's title and information.
  GltfDocument(const World& world, bool binary);

  // The top level of the document, for what has no function here.
  nlohmann::json json;
  bool binary() const { return binary_; }

  // Each adds an accessor and gives its number. Positions carry their bounds; uvs, of which v
  // points up, are turned to glTF's.
  std::size_t add_positions(std::span<const Vec3f> values);
  std::size_t add_vectors(std::span<const Vec3f> values);
  std::size_t add_uvs(std::vector<Vec2f> values);
  std::size_t add_indices(std::span<const std::uint32_t> values);

  // Data of any kind: `view` is what its buffer view says besides where the bytes lie, `accessor`
  // names a view. Each gives its number.
  std::size_t add_view(const void* data, std::size_t size, nlohmann::json view);
  std::size_t add_accessor(nlohmann::json accessor);

  // One line more of information on the whole file.
  void add_info(const std::string& line);

  // An image whose file is embedded in a .glb, and an image that lies beside a .gltf.
  nlohmann::json embedded_image(std::span<const char> bytes, const char* mime_type);
  static nlohmann::json image_beside(const std::string& file_name);

  // Writes the files under their temporary names; adds to result.bytes.
  Status write(const std::filesystem::path& path, AtomicFiles& files, WorldFile& result);

 private:
  std::size_t add_bounded(std::span<const Vec3f> values, const nlohmann::json& bounds);
  std::string text(const std::string& buffer_uri);

  bool binary_;
  std::string bytes_;
};

// The node that turns the world's up to +Y, scales to metres and adds the origin, without its
// children.
nlohmann::json gltf_root(const World& world);

}  // namespace atlas
