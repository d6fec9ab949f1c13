// Internal: SceneBuilder, with which all readers turn parsed vertices and faces into a Scene.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libatlas/core/polygon.h"
#include "libatlas/core/vec.h"
#include "libatlas/scene/building/coloured_points.h"
#include "libatlas/scene/files/mtl_names.h"
#include "libatlas/scene/reader.h"
#include "libatlas/scene/uv_page.h"

namespace atlas {

struct TextureImage;

// A texture before it is decoded: a file, or encoded bytes embedded in the scene's file.
struct RawTexture {
  std::filesystem::path path;  // of the file, or a name for messages
  std::vector<std::uint8_t> bytes;
  std::string place;  // where the scene's file names it
  // Whether an extension names it, because its format is none that glTF itself has. A scene that is
  // kept has its file as it is.
  bool of_extension = false;
};

// `texture` is an index into SceneBuilder::textures.
struct RawMaterial : Material {
  // The texture coordinates of its triangles become row[0] u + row[1] v + row[2], with one row each
  // for u and v.
  std::array<double, 3> uv_u{1, 0, 0}, uv_v{0, 1, 0};
  int uv_set = 0;  // which of the file's sets of texture coordinates they are
  // The set whose page is that of all these texture coordinates, which may be another one that
  // refers to the same data; -1: uv_set.
  int page_set = -1;

  bool moves_uv() const {
    return uv_u != std::array<double, 3>{1, 0, 0} || uv_v != std::array<double, 3>{0, 1, 0};
  }
};

// Returns whether a position can be stored as floats.
inline bool usable_position(const Vec3d& p) {
  constexpr double kMax = std::numeric_limits<float>::max();
  return std::abs(p.x) <= kMax && std::abs(p.y) <= kMax && std::abs(p.z) <= kMax;
}

// The corners of a polygon, in lists of equal length; `uvs` and `normals` are empty if there are
// none. `vertices` are indices into positions, `uvs` into texcoords and `normals` into normals.
// Indices may be kNoIndex or out of range.
struct FaceCorners {
  std::span<const std::int64_t> vertices;
  std::span<const std::int64_t> uvs = {}, normals = {};
};

// Readers fill the vertex arrays first, then add faces, then finish.
class SceneBuilder {
 public:
  explicit SceneBuilder(const std::filesystem::path& path) : file(path.string()) {}

  static constexpr std::int64_t kNoIndex = std::numeric_limits<std::int64_t>::min();

  std::string file;               // for messages
  std::string illumination_file;  // for messages, if the illumination is another file's
  std::vector<Vec3d> positions;
  std::vector<Vec3f> illumination;    // empty or 1 per vertex; checked by finish()
  std::vector<float> vertex_opacity;  // empty or 1 per vertex; only filled if wants_rest is set
  std::vector<Vec3f> unlit_colours;   // Scene::unlit_colours, for the first vertices or all
  bool linear_light = false;          // whether the format says that the illumination is linear
  // Colours of faces, for the first triangles or all; used if no vertex has a colour. Their corners
  // get them, and vertices of faces that differ are divided by finish().
  std::vector<std::optional<VertexColour>> triangle_colours;
  std::vector<Vec2f> texcoords;
  std::vector<Vec3f> normals;  // of any length; only filled if wants_normals is set
  std::vector<RawMaterial> materials;
  std::vector<RawTexture> textures;
  std::vector<std::int32_t> texture_numbers;  // once loaded: of each in Scene::textures, or -1
  std::vector<std::vector<std::uint8_t>> image_files;  // GltfSource::image_files, of `textures`
  std::vector<std::string> objects;
  DefectReport defects;
  bool wants_textures = true;                     // false: `textures` need not hold any bytes
  bool wants_normals = false;                     // false: normals are ignored, whatever they hold
  bool wants_polygons = false;                    // ReadOptions::polygons
  bool wants_rest = false;                        // ReadOptions::rest
  bool wants_told_uvs = false;                    // ReadOptions::told_uvs
  bool wants_lightmap = false;                    // ReadOptions::lightmap
  float light_white = 0;                          // SceneLightmap::white, of light_page
  std::shared_ptr<const SceneLightmap> lightmap;  // Scene::lightmap
  ImageF light_page;  // if not empty, the only page of a lightmap whose uvs are `texcoords`
  std::shared_ptr<GltfSource> source;        // Scene::source; if set, all of `textures` are kept
  NamedFiles named_files;                    // finds the files that the scene names
  Status refused;                            // may_read() has refused a file
  bool limits = true;                        // ReadOptions::limits
  LossCounts not_read;                       // Scene::not_read, without the materials' MTL lines
  std::vector<std::filesystem::path> files;  // LoadedScene::files
  // What the file names besides `files` and `textures`; part of LoadedScene::unread_files.
  std::vector<std::filesystem::path> other_files;
  UvPages uv_pages;              // what the file says of the pages of its uvs
  std::optional<FileView> view;  // LoadedScene::view
  std::vector<FileView> further_views;

  // What the next faces belong to.
  std::uint32_t material = 0, object = 0;
  std::optional<VertexColour> face_colour;

  // Checks that positions are finite floats; call once, after they are complete.
  template <class Place>
  void check_positions(const Place& place_of_vertex) {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      if (usable_position(positions[i])) continue;
      all_usable_ = false;
      defects.add(DefectKind::position_not_finite, [&] { return place_of_vertex(i); });
    }
  }

  // Returns whether a file that the scene names may be read. If not, reading ends with `refused`,
  // in which `place` says where the first such file is named.
  bool may_read(const std::filesystem::path& named, const std::string& place);

  // Takes where a viewer is and where it looks, unless there is such a view already, or it is none
  // of finite numbers. The direction may have any length.
  void take_view(const Vec3d& position, const Vec3d& direction, std::string name);

  // Returns the index of this file's texture, which all that ask for it share. `place` says where
  // it is asked for; the first one is kept for messages.
  std::int32_t texture_of(const std::filesystem::path& texture_file, const std::string& place);

  void reserve_triangles(std::size_t count, bool with_texcoords);

  // Adds a polygon as triangles.
  template <class Place>
  void add_face(FaceCorners face, const Place& place) {
    const auto vertices = face.vertices;
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
    if (!all_given(face.uvs, texcoords.size(), kTexcoordDefects, place)) face.uvs = {};
    if (!all_given(face.normals, normals.size(), kNormalDefects, place)) face.normals = {};
    if (vertices.size() == 3) {
      triangles_.assign(1, {0, 1, 2});
      return add_triangles(face);
    }
    if (goes_round_and_round(vertices)) return drop(DefectKind::polygon_repeated, place);
    corners_.clear();
    for (const std::int64_t v : vertices) corners_.push_back(positions[v]);
    if (!triangulate(corners_, triangles_, limits)) {
      defects.add(DefectKind::polygon_too_large, place);
    }
    add_triangles(face);
  }

  std::size_t triangle_count() const { return indices_.size() / 3; }

  // Completes the scene after parsing: sanitises illumination and texture coordinates, chooses the
  // origin, drops materials, objects and textures that no triangle uses, and decodes textures.
  Result<LoadedScene> finish(const ReadOptions& options, const Context& context);

 private:
  template <class Place>
  void drop(DefectKind kind, const Place& place) {
    defects.add(kind, place);
    ++defects.triangles_left_out;
  }

  struct AttributeDefects {
    DefectKind out_of_range, partial;
  };
  static constexpr AttributeDefects kTexcoordDefects{DefectKind::texcoord_out_of_range,
                                                     DefectKind::texcoord_partial};
  static constexpr AttributeDefects kNormalDefects{DefectKind::normal_out_of_range,
                                                   DefectKind::normal_partial};

  // Returns whether every corner names one of `count` attributes. Adds a defect if only some do, or
  // if an index is out of range.
  template <class Place>
  bool all_given(std::span<const std::int64_t> indices, std::size_t count,
                 const AttributeDefects& kinds, const Place& place) {
    std::size_t absent = 0;
    for (const std::int64_t i : indices) {
      if (i == kNoIndex) {
        ++absent;
      } else if (i < 0 || i >= static_cast<std::int64_t>(count)) {
        defects.add(kinds.out_of_range, place);
        return false;
      }
    }
    if (absent != 0 && absent != indices.size()) defects.add(kinds.partial, place);
    return absent == 0;
  }

  void add_triangles(const FaceCorners& face) {
    for (const auto& t : triangles_) add_triangle(face, t);
    if (wants_polygons) polygons_.add(face.vertices.size(), triangles_);
  }

  void add_triangle(const FaceCorners& face, std::array<std::uint32_t, 3> corners) {
    const auto [vertices, uvs, face_normals] = face;
    add_attributes(uvs, corners, texcoord_indices_);
    if (wants_normals) add_attributes(face_normals, corners, normal_indices_);
    for (const std::uint32_t c : corners)
      indices_.push_back(static_cast<std::uint32_t>(vertices[c]));
    triangle_material_.push_back(material);
    triangle_object_.push_back(object);
    if (!face_colour) return;
    triangle_colours.resize(triangle_count());
    triangle_colours.back() = face_colour;
  }

  // Adds the indices of a triangle's attributes, `given` or none. The list stays empty until a
  // triangle has some, as those of many large files never do.
  void add_attributes(std::span<const std::int64_t> given,
                      const std::array<std::uint32_t, 3>& corners,
                      std::vector<std::uint32_t>& list) const {
    static_assert(Scene::kNoTexcoord == Scene::kNoNormal);
    if (given.empty() && list.empty()) return;
    list.resize(indices_.size(), Scene::kNoTexcoord);
    for (const std::uint32_t c : corners)
      list.push_back(given.empty() ? Scene::kNoTexcoord : static_cast<std::uint32_t>(given[c]));
  }

  void colour_corners();
  void sanitise_values();
  void sanitise_opacity();
  void decode_colours();
  Status place_positions(Scene& scene);
  void keep_used(Scene& scene);
  void move_texcoords();
  void lay_on_light_page();
  void place_normals(Scene& scene);
  void place_uv_aspects(LoadedScene& loaded) const;
  void place_materials(const ReadOptions& options, Scene& scene);
  void note_file(const RawTexture& raw);
  std::vector<std::filesystem::path> unread_files() const;
  Status load_textures(Scene& scene, bool encoded, const Context& context);
  bool keep_encoded(std::size_t texture, Scene& scene);
  std::vector<bool> textures_of_materials() const;
  Result<TextureImage> load_texture(const RawTexture& raw) const;

  bool all_usable_ = true;
  // The latter two are empty if no triangle has any, else as long as the first.
  std::vector<std::uint32_t> indices_, texcoord_indices_, normal_indices_;
  std::vector<std::uint32_t> triangle_material_, triangle_object_;
  std::vector<Vec3d> corners_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  PolygonCorners polygons_;
  std::map<std::filesystem::path, std::int32_t> texture_files_;  // by texture_of()'s argument
};

}  // namespace atlas
