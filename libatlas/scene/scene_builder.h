// Internal: what all readers share between parsing and the finished Scene.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "libatlas/core/vec.h"
#include "libatlas/scene/polygon.h"
#include "libatlas/scene/reader.h"

namespace atlas {

// A texture before it is decoded: a file, or encoded bytes embedded in the scene's file.
struct RawTexture {
  std::filesystem::path path;  // of the file, or a name for messages
  std::vector<std::uint8_t> bytes;
  std::string place;  // where it is asked for
};

struct RawMaterial {
  std::string name;
  Vec3f diffuse{1, 1, 1};
  std::int32_t texture = -1;
  // Texture coordinates of its triangles become row[0] u + row[1] v + row[2].
  std::array<double, 3> uv_u{1, 0, 0}, uv_v{0, 1, 0};

  bool moves_uv() const {
    return uv_u != std::array<double, 3>{1, 0, 0} || uv_v != std::array<double, 3>{0, 1, 0};
  }
};

// Whether a position can be kept as floats.
inline bool usable_position(const Vec3d& p) {
  constexpr double kMax = std::numeric_limits<float>::max();
  return std::abs(p.x) <= kMax && std::abs(p.y) <= kMax && std::abs(p.z) <= kMax;
}

// Readers fill the vertex arrays first, then add faces, then finish.
class SceneBuilder {
 public:
  explicit SceneBuilder(const std::filesystem::path& path) : file(path.string()) {}

  static constexpr std::int64_t kNoIndex = std::numeric_limits<std::int64_t>::min();

  std::string file;               // for messages
  std::string illumination_file;  // likewise, where the illumination is another file's
  std::vector<Vec3d> positions;
  std::vector<Vec3f> illumination;  // empty or 1 a vertex; checked by finish()
  std::vector<Vec2f> texcoords;
  std::vector<RawMaterial> materials;
  std::vector<RawTexture> textures;
  std::vector<std::string> objects;
  DefectReport defects;
  bool wants_textures = true;                // false: `textures` need not hold any bytes
  std::vector<std::filesystem::path> files;  // LoadedScene::files

  // What the next faces belong to.
  std::uint32_t material = 0, object = 0;

  // Checks that positions are finite floats; call once, after they are complete.
  template <class Place>
  void check_positions(const Place& place_of_vertex) {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      if (usable_position(positions[i])) continue;
      all_usable_ = false;
      defects.add(DefectKind::position_not_finite, [&] { return place_of_vertex(i); });
    }
  }

  void reserve_triangles(std::size_t count, bool with_texcoords);

  // Adds a polygon as triangles. `vertices` index positions, `uvs` (empty or as many) index
  // texcoords or are kNoIndex; both may be out of range.
  template <class Place>
  void add_face(std::span<const std::int64_t> vertices, std::span<const std::int64_t> uvs,
                const Place& place) {
    if (vertices.size() < 3) return drop(DefectKind::too_few_corners, place);
    const auto count = static_cast<std::int64_t>(positions.size());
    for (const std::int64_t v : vertices) {
      if (v < 0 || v >= count) return drop(DefectKind::index_out_of_range, place);
    }
    if (!all_usable_) {
      for (const std::int64_t v : vertices) {
        if (!usable_position(positions[v])) return drop(DefectKind::bad_position_used, place);
      }
    }
    if (!uvs.empty() && !check_uvs(uvs, place)) uvs = {};
    if (vertices.size() == 3) return add_triangle(vertices, uvs, {0, 1, 2});
    corners_.clear();
    for (const std::int64_t v : vertices) corners_.push_back(positions[v]);
    if (!triangulate(corners_, triangles_)) {
      defects.add(DefectKind::polygon_too_large, place);
    }
    for (const auto& t : triangles_) add_triangle(vertices, uvs, t);
  }

  std::size_t triangle_count() const { return indices_.size() / 3; }

  // Everything after parsing: sanitises illumination and texture coordinates, chooses the origin,
  // drops what no triangle uses, decodes textures.
  Result<LoadedScene> finish(const ReadOptions& options, const Context& context);

 private:
  template <class Place>
  void drop(DefectKind kind, const Place& place) {
    defects.add(kind, place);
    ++defects.triangles_left_out;
  }

  template <class Place>
  bool check_uvs(std::span<const std::int64_t> uvs, const Place& place) {
    std::size_t absent = 0;
    for (const std::int64_t t : uvs) {
      if (t == kNoIndex) {
        ++absent;
      } else if (t < 0 || t >= static_cast<std::int64_t>(texcoords.size())) {
        defects.add(DefectKind::texcoord_out_of_range, place);
        return false;
      }
    }
    if (absent != 0 && absent != uvs.size()) defects.add(DefectKind::texcoord_partial, place);
    return absent == 0;
  }

  void add_triangle(std::span<const std::int64_t> vertices, std::span<const std::int64_t> uvs,
                    std::array<std::uint32_t, 3> corners) {
    for (const std::uint32_t c : corners) {
      indices_.push_back(static_cast<std::uint32_t>(vertices[c]));
      texcoord_indices_.push_back(uvs.empty() ? Scene::kNoTexcoord
                                              : static_cast<std::uint32_t>(uvs[c]));
    }
    any_texcoord_ |= !uvs.empty();
    triangle_material_.push_back(material);
    triangle_object_.push_back(object);
  }

  void sanitise_values();
  Status place_positions(Scene& scene) const;
  void keep_used(Scene& scene);
  void move_texcoords();
  void load_textures(Scene& scene);
  Result<Image8> load_texture(const RawTexture& raw) const;

  bool all_usable_ = true, any_texcoord_ = false;
  std::vector<std::uint32_t> indices_, texcoord_indices_, triangle_material_, triangle_object_;
  std::vector<Vec3d> corners_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

}  // namespace atlas
