// Internal: GltfDocument, a glTF document under construction, with its binary data and the files
// that it becomes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "libatlas/core/status.h"
#include "libatlas/exporters/gltf/gltf_packing.h"
#include "libatlas/exporters/world.h"
#include "libatlas/files/atomic_file.h"

namespace atlas {

// Values of a sampler, which are OpenGL's.
inline constexpr int kLinear = 9729, kLinearMipmapLinear = 9987, kClampToEdge = 33071,
                     kMirroredRepeat = 33648;

// Says on which page of the world's lightmap the triangles of a primitive are, as its
// extras.lightmap, if there are several.
void name_lightmap_page(const World& world, std::uint32_t page, nlohmann::json& primitive);

// Makes a number the extras.lightmap of a primitive. -1: it lies on no page.
void set_lightmap_page(std::int64_t page, nlohmann::json& primitive);

class GltfDocument {
 public:
  // The document begins with the world's title and information. `binary`: whether it becomes a
  // .glb. Attributes and indices are packed (EXT_meshopt_compression) if the world says so.
  GltfDocument(const World& world, bool binary);

  // The top level of the document, for parts that have no function here.
  nlohmann::json json;
  bool binary() const { return binary_; }

  // Each adds an accessor and returns its number. Positions carry their bounds. The v coordinates
  // of uvs point up in `values`; they are reversed as glTF requires.
  std::size_t add_positions(std::span<const Vec3f> values);
  std::size_t add_vectors(std::span<const Vec3f> values);
  // RGBA of `colours` and as many `alphas`.
  std::size_t add_colours(std::span<const Vec3f> colours, std::span<const float> alphas);
  std::size_t add_uvs(std::vector<Vec2f> values);
  // The same as whole numbers of 16 bits (KHR_mesh_quantization). Uvs are within 0..1.
  std::size_t add_positions(std::span<const Vec3f> values, const PositionGrid& grid);
  std::size_t add_short_uvs(std::span<const Vec2f> values);
  // Vectors of zeros, with bounds, which take no space in the file.
  std::size_t add_zeros(std::size_t count);
  // Indices of triangles have 16 bits where that is enough.
  std::size_t add_indices(std::span<const std::uint32_t> values);

  // Add data of any kind, and return its number. `view` holds the properties of the buffer view
  // except where its bytes are; `accessor` names a view.
  std::size_t add_view(const void* data, std::size_t size, nlohmann::json view);
  std::size_t add_accessor(nlohmann::json accessor);
  // Adds a view of an attribute's values, `stride` bytes each (a multiple of 4, as glTF requires).
  std::size_t add_vertices(const void* data, std::size_t count, std::size_t stride);

  // Says that the file uses, or cannot be read without, an extension.
  void use(const char* extension, bool required = false);

  // Adds a line of information on the whole file.
  void add_info(const std::string& line);

  // Makes the information say that these sets, TEXCOORD_0 and so on, hold the world's uvs: each
  // line that says a page of uvs (scene/uv_page.h) becomes one for each set.
  void name_uv_sets(const std::set<std::int64_t>& sets);

  // Names the world's lightmap, if it has one, with the set of uvs that addresses it.
  void name_lightmap(const World& world, std::int64_t uv_set);

  // Returns an image whose file is embedded in a .glb (embedded_image), or lies beside a .gltf
  // (image_beside).
  nlohmann::json embedded_image(std::span<const char> bytes, const char* mime_type);
  static nlohmann::json image_beside(const std::string& file_name);

  // Writes the files under their temporary names, and adds their sizes to result.bytes. Errors: io,
  // unsupported (more than 4 GB of data).
  Status write(const std::filesystem::path& path, AtomicFiles& files, WorldFile& result);

 private:
  // Describes `bytes`, which are packed, by the view of what they become.
  std::size_t add_packed(const std::string& bytes, nlohmann::json view, nlohmann::json packing);
  std::size_t add_bounded(std::span<const Vec3f> values, const nlohmann::json& bounds);
  std::string text(const std::string& buffer_uri);

  bool binary_;
  bool compress_;
  std::string bytes_;
  std::size_t unpacked_bytes_ = 0;  // of views that are packed
};

// Returns a position of the world's coordinates, in metres and y-up.
nlohmann::json gltf_position(const World& world, const Vec3d& position);

// Returns the node, still without children, that turns the world's up axis to +Y, scales to metres
// and adds `origin`, which is in the world's coordinates.
nlohmann::json gltf_root(const World& world, const Vec3d& origin);

// Returns the node that adds the origin of a world that is too far from zero for floats to all root
// nodes, which are its children. Engines that hold single floats show such a world if this one
// node is moved to zero.
nlohmann::json gltf_far_origin(const World& world, nlohmann::json children);

}  // namespace atlas
