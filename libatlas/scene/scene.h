// The input of everything: one indexed triangle mesh with materials, textures and illumination.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "libatlas/core/image.h"
#include "libatlas/core/vec.h"

namespace atlas {

struct GltfSource;  // internal to the library

// How often each kind of thing occurs. Kinds are in the plural, for example "animations".
using LossCounts = std::map<std::string, std::size_t>;

// What a fourth channel means: nothing, holes where it is below a threshold, or glass.
enum class AlphaMode : std::uint8_t { opaque, mask, blend };

// How a texture goes on outside [0, 1]: again and again, mirrored each time, or as at its edge.
enum class TextureWrap : std::uint8_t { repeat, mirror, clamp };

// Lambertian reflectance: diffuse (linear RGB, 0..1; others are used as they are) times the
// texture, if there is one.
struct Material {
  std::string name;
  Vec3f diffuse{1, 1, 1};
  std::int32_t texture = -1;  // index into Scene::textures, or -1
  TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
  // Handed on by exports that keep the scene. To light every surface is opaque.
  float opacity = 1;  // 0..1, times the texture's
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;  // the threshold of holes, >= 0
  bool double_sided = true;   // seen from behind, too
  // What it sends out by itself, linear RGB >= 0 in no unit that is known: handed on likewise, and
  // no part of what is baked. Where a texture shapes it, that is not read.
  Vec3f emission{0, 0, 0};
  bool emission_textured = false;
  bool opacity_textured = false;  // by a texture of its own (map_d), which is not read
  // Of MTL, where asked for (ReadOptions::rest): its lines but newmtl and Kd, for exports that keep
  // the scene.
  std::vector<std::string> mtl_lines = {};
};

// A diffuse texture. Values are 8-bit sRGB-encoded, origin bottom left.
struct Texture {
  std::filesystem::path path;  // where it was read from, for messages
  Image8 image;                // at least 1 channel; grey is channel 0, colour channels 0..2
  // A whole PNG or JPEG file in place of `image`, which is empty then: for exports that keep the
  // scene's textures and do not look into them (ReadOptions::encoded_textures).
  std::vector<std::uint8_t> encoded = {};
};

// Whether it is what a surface can reflect.
inline bool is_reflectance(const Vec3f& c) {
  return c.x >= 0 && c.y >= 0 && c.z >= 0 && c.x <= 1 && c.y <= 1 && c.z <= 1;
}

// Light up to here can be worked with: beyond it sums of floats end.
inline constexpr float kMostLight = 1e36f;

// Flat arrays. A triangle t has corners 3t, 3t+1, 3t+2; input order is kept. A program that fills
// them in by itself needs positions, indices and mostly illumination; complete_scene()
// (check_scene.h) adds the rest.
struct Scene {
  Vec3d origin;                        // added to every position gives the coordinates of the file
  double metres_per_unit = 1;          // length of one scene unit
  std::vector<Vec3f> positions;        // finite, relative to origin
  std::vector<Vec3f> illumination;     // linear RGB a vertex, up to kMostLight; empty: none given
  std::vector<Vec2f> texcoords;        // finite; may lie outside [0, 1]
  std::vector<std::uint32_t> indices;  // 3 a triangle, into positions
  std::vector<std::uint32_t> texcoord_indices;  // 3 a triangle, into texcoords, kNoTexcoord where
                                                // the file gives none; empty: no triangle has any
  std::vector<Vec3f> normals;  // unit length within 1 %; empty: none given, or none asked for
  std::vector<std::uint32_t> normal_indices;     // 3 a triangle, into normals, kNoNormal where
                                                 // none is given; empty: no triangle has any
  std::vector<std::uint32_t> triangle_material;  // 1 a triangle, into materials
  std::vector<std::uint32_t> triangle_object;    // 1 a triangle, into object_names, or empty
  std::vector<Material> materials;               // at least one when there are triangles
  std::vector<Texture> textures;
  std::vector<std::string> object_names;
  // Of glTF, where asked for (ReadOptions::rest): the file itself. An export to glTF that keeps the
  // scene writes it again, so triangles and positions must be those that were read.
  std::shared_ptr<const GltfSource> source;
  // What the file has and the other members do not hold, if ReadOptions::rest was not set. An
  // export that keeps the scene lists it as not kept.
  LossCounts not_read = {};

  static constexpr std::uint32_t kNoTexcoord = 0xffffffffu;
  static constexpr std::uint32_t kNoNormal = 0xffffffffu;

  std::size_t triangle_count() const { return indices.size() / 3; }
  bool lit() const { return !illumination.empty(); }
  bool textured() const { return !textures.empty(); }
};

}  // namespace atlas
