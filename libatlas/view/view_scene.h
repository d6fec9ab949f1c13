// Turns a scene into arrays that can be drawn: computes normals, welds corners, and groups
// triangles by texture.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/scene/reader.h"
#include "libatlas/scene/scene.h"
#include "libatlas/shadow/fit.h"

namespace atlas {

// Which of a scene's materials are unlit: they show light, and reflect none.
enum class Unlit { none, some, all };

struct ViewScene {
  // Per vertex; an array is empty where the scene has no such thing.
  std::vector<Vec3f> positions = {}, normals = {};
  // Diffuse reflectance of the material, linear; that of unlit ones with a texture is multiplied by
  // Scene::unlit_colours.
  std::vector<Vec3f> colours = {};
  std::vector<Vec3f> emission = {};  // of the material, unless a texture shapes it; 1 is white
  std::vector<Vec2f> texcoords = {};
  // Linear, as given; 1 / light_scale where a texture shows light, to which it adds nothing; 0
  // where the lightmap has the light.
  std::vector<Vec3f> illumination = {};
  std::vector<Vec2f> light_texcoords = {};        // on the lightmap's pages
  std::vector<std::uint8_t> unlit_vertices = {};  // 1 or 0; empty unless `unlit` is `some`
  std::vector<std::uint32_t> indices = {};

  // A texture (-1: none), how it continues beyond its edges, whether triangles are left out where
  // their back is seen, whether the texture is an atlas page (it is unlit and clamped), and the
  // texture's alpha below which there are holes (0: there are none).
  struct Look {
    std::int32_t texture = -1;
    TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
    bool one_sided = false;
    bool page = false;
    float cutoff = 0;
    std::int32_t light_page = -1;  // of the lightmap; -1: light of the vertices, if they have any
    auto operator<=>(const Look&) const = default;
  };

  // Consecutive triangles that lie close together and look alike. A frame can skip clusters that
  // are out of view and draw the nearest first.
  struct Cluster {
    std::uint32_t first = 0, count = 0;  // indices
    Look look;
    Vec3f centre;  // of a sphere that contains them
    float radius = 0;
  };
  std::vector<Cluster> clusters = {};  // grouped by look

  // What casts shadows: the same triangles over welded positions, without those that are more than
  // half transparent, and without clusters with holes, which cast their own shadows.
  std::vector<Vec3f> caster_positions = {};
  std::vector<std::uint32_t> caster_indices = {};

  std::vector<Texture> textures = {};
  // Its pages hold light that is added to that of the vertices. Null unless a cluster shows some.
  std::shared_ptr<const SceneLightmap> lightmap = {};
  Unlit unlit = Unlit::none;
  Box3 bounds = {};   // of the positions that triangles use
  Box3 middle = {};   // of these without the 5 % that lie outermost at each end of each axis
  Vec3d origin = {};  // added to a position, gives the coordinates of the file
  std::optional<FileView> start = {};  // where the file says that a viewer begins
  // LoadedScene::files and unread_files, which pictures must not replace. Like `start`, load_view()
  // fills it in.
  std::vector<std::filesystem::path> files = {};
  double metres_per_unit = 1;  // > 0; used for the height of a visitor's eye
  // Exposure that puts the white of the lightmap at 1, or the 99th percentile of the light where no
  // white is named.
  double light_scale = 1;

  std::size_t triangle_count() const { return indices.size() / 3; }
  bool textured() const { return !texcoords.empty(); }
  bool baked() const { return !illumination.empty() || lightmap || unlit == Unlit::all; }
};

struct ViewSceneOptions {
  double crease_degrees = 40;  // faces that meet at less than this are shaded as one surface
  // Whether textures hold light (baked pages) or reflectance. Nothing: as Material::unlit says.
  // Otherwise all textured materials are unlit, or none is, textured or not. Baked pages hold the
  // light of a surface's front: unlit materials that are not double-sided (Material::double_sided)
  // are left out from behind, and no others.
  std::optional<bool> textures_hold_light = {};
  // The light at the vertices is the surface's colour (linear, ReadOptions::srgb_colours), as scans
  // have it: it takes the place of all other reflectance, and textures are not shown.
  bool vertices_hold_colours = false;
  // Triangles per cluster: few enough to follow the depth order, many enough that their draw calls
  // cost little (256 to 1024 measured alike on the software renderer).
  std::uint32_t cluster_triangles = 512;
};

// Leaves out triangles that AlphaMode::mask makes invisible. Other transparent ones are opaque.
// Errors: bad_input if there is no triangle to draw; those of check_scene().
Result<ViewScene> make_view_scene(const Scene& scene, const ViewSceneOptions& options,
                                  const Context& context = {});

}  // namespace atlas
