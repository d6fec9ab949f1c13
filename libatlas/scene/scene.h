// The input of all other modules: one indexed triangle mesh with materials, textures and
// illumination.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "libatlas/core/image.h"
#include "libatlas/core/polygon.h"
#include "libatlas/core/vec.h"

namespace atlas {

struct GltfSource;  // internal to the library

// How often each kind of thing occurs. Kinds are in the plural, for example "animations".
using LossCounts = std::map<std::string, std::size_t>;

// What a fourth channel means: nothing (opaque), holes where it is below a threshold (mask), or
// transparency as of glass (blend).
enum class AlphaMode : std::uint8_t { opaque, mask, blend };

// How a texture continues outside [0, 1]: repeated, mirrored at each repeat, or with its edge
// texels.
enum class TextureWrap : std::uint8_t { repeat, mirror, clamp };

// Lambertian reflectance: the diffuse colour times the texture, if there is one. The colour is
// linear RGB, 0..1; values outside are used as they are.
struct Material {
  std::string name = {};
  Vec3f diffuse{1, 1, 1};
  std::int32_t texture = -1;  // index into Scene::textures, or -1
  TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
  // The members below are passed on by exports that keep the scene. Lighting treats every surface
  // as opaque.
  float opacity = 1;  // 0..1, multiplied by the texture's
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;  // the threshold of AlphaMode::mask, >= 0
  bool double_sided = true;   // visible from behind, too
  // What it shows is light already: neither light nor shadows change it (KHR_materials_unlit; VRML
  // textures without a Material; textures of an MTL with illum 0).
  bool unlit = false;
  // Emitted light, linear RGB >= 0 in an unknown unit. It is passed on likewise, and is not part of
  // what is baked. A texture of the emission is not read.
  Vec3f emission{0, 0, 0};
  bool emission_textured = false;
  bool opacity_textured = false;  // by a texture of its own (map_d), which is not read
  bool opacity_by_view = false;   // by the direction of view (d -halo), which is not read
  // The material's lines in the MTL file, except newmtl and Kd, if asked for (ReadOptions::rest):
  // for exports that keep the scene.
  std::vector<std::string> mtl_lines = {};
};

// A diffuse texture. Values are 8-bit sRGB-encoded, origin bottom left.
struct Texture {
  std::filesystem::path path = {};  // where it was read from, for messages
  Image8 image = {};                // at least 1 channel; grey is channel 0, colour channels 0..2
  // A whole PNG or JPEG file in place of `image`, which is then empty: for exports that keep the
  // scene's textures without decoding them (ReadOptions::encoded_textures).
  std::vector<std::uint8_t> encoded = {};
};

// Light in images, in place of light at the vertices. Triangles address it by texture coordinates
// of its own.
struct SceneLightmap {
  // Linear RGB in the unit of Scene::illumination, finite. The origin is at the bottom left. Pages
  // on which no triangle lies are empty.
  std::vector<ImageF> pages = {};
  std::vector<Vec2f> texcoords = {};  // finite
  // 3 per triangle, into texcoords, or kNoTexcoord for all three of a triangle that has its light,
  // if any, at its vertices.
  std::vector<std::uint32_t> texcoord_indices = {};
  std::vector<std::uint32_t> triangle_page = {};  // 1 per triangle, into pages
  float white = 0;  // the light that is meant to be shown as white, in that unit; 0: not known
};

// Returns whether a surface can reflect this share of the light: all components are within 0..1.
inline bool is_reflectance(const Vec3f& c) {
  return c.x >= 0 && c.y >= 0 && c.z >= 0 && c.x <= 1 && c.y <= 1 && c.z <= 1;
}

// The largest usable illumination. Sums of larger values would exceed the range of float.
inline constexpr float kMostLight = 1e36f;

// Flat arrays. Triangle t has the corners 3t, 3t + 1 and 3t + 2; the order of the input is kept. A
// program that fills the arrays by itself needs positions, indices and usually illumination;
// complete_scene() (check_scene.h) adds the rest.
struct Scene {
  Vec3d origin = {};                     // added to a position, gives the coordinates of the file
  double metres_per_unit = 1;            // length of one scene unit
  std::vector<Vec3f> positions = {};     // finite, relative to origin
  std::vector<Vec3f> illumination = {};  // linear RGB per vertex, up to kMostLight; may be empty
  // Alpha of the vertices' colours, 0..1 per vertex; empty if all is 1, or it is not asked for
  // (ReadOptions::rest). Exports that keep the scene pass it on. Lighting ignores it.
  std::vector<float> vertex_opacity = {};
  // What multiplies the textures of unlit materials, linear RGB, 0..1 per vertex: COLOR_0 of glTF,
  // which is the illumination of other materials. Empty if all is 1. Lighting ignores it.
  std::vector<Vec3f> unlit_colours = {};
  std::vector<Vec2f> texcoords = {};        // finite; may lie outside [0, 1]
  std::vector<std::uint32_t> indices = {};  // 3 per triangle, into positions
  // 3 per triangle, into texcoords, or kNoTexcoord if the file gives none there; empty if no
  // triangle has any
  std::vector<std::uint32_t> texcoord_indices = {};
  std::vector<Vec3f> normals = {};  // unit length within 1 %; empty if none is given or asked for
  // 3 per triangle, into normals, or kNoNormal if none is given there; empty if no triangle has any
  std::vector<std::uint32_t> normal_indices = {};
  std::vector<std::uint32_t> triangle_material = {};  // 1 per triangle, into materials
  std::vector<std::uint32_t> triangle_object = {};    // 1 per triangle, into object_names, or empty
  std::vector<Material> materials = {};               // at least one when there are triangles
  std::vector<Texture> textures = {};
  std::vector<std::string> object_names = {};
  // The file's faces, of which the triangles are parts, if asked for (ReadOptions::polygons).
  PolygonCorners polygons = {};
  // Null if the file names none, or it is not asked for (ReadOptions::lightmap). Exports ignore it.
  std::shared_ptr<const SceneLightmap> lightmap = {};
  // The glTF file itself, if asked for (ReadOptions::rest). An export to glTF that keeps the scene
  // writes it again, so triangles, positions and origin must still be those that were read: others
  // are refused. Changes to the other arrays are not written, except to light that came from
  // another file. A program that changes the scene sets `source` to null. The export then writes
  // the arrays, and lists `not_read` as not kept.
  std::shared_ptr<const GltfSource> source = {};
  // Counts what the file has but the other members, except `source`, do not hold. An export that
  // keeps the scene without `source` lists it as not kept.
  LossCounts not_read = {};

  static constexpr std::uint32_t kNoTexcoord = 0xffffffffu;
  static constexpr std::uint32_t kNoNormal = 0xffffffffu;

  std::size_t triangle_count() const { return indices.size() / 3; }
  bool lit() const { return !illumination.empty(); }
  bool textured() const { return !textures.empty(); }
};

}  // namespace atlas
