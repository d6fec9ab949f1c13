// What every exporter writes: a textured, unlit mesh whose textures are the atlas pages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "libatlas/core/atomic_file.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"

namespace atlas {

struct Scene;  // libatlas/scene/scene.h

enum class Up { y, z };

// Where a viewer starts, in the coordinates of World::positions (that is, relative to the origin).
struct Viewpoint {
  Vec3d position;
  Vec3d direction{0, 0, -1};  // of view; not zero, not along the up axis
  double fov = 1.0;           // radians, in (0, pi); of the smaller side of the window
  bool inside = false;  // the scene surrounds it: viewers walk; otherwise they turn the object
};

struct Page {
  std::string image;  // file name beside the world, see safe_file_name(); empty: no texture
  std::filesystem::path image_source;  // where the finished image lies while the world is written;
                                       // only .glb needs it, which embeds it
  std::vector<std::uint32_t> indices;  // 3 a triangle, into World::positions
  std::vector<std::uint32_t> uv_indices;  // 3 a triangle, into World::uvs
};

struct World {
  Vec3d origin;                  // added to every position gives the coordinates of the file
  double metres_per_unit = 1;    // > 0
  Up up = Up::y;                 // the scene's up axis; coordinates are written unchanged
  std::vector<Vec3f> positions;  // finite; shared by all pages
  std::vector<Vec2f> uvs;        // finite, 0..1, origin bottom left
  std::vector<Page> pages;
  std::string title;
  std::vector<std::string> info;  // one line each, for WorldInfo and comments
  Viewpoint viewpoint;
  // Not null: the scene that the uvs are for, written with its own objects, materials, normals and
  // texture coordinates (see write_gltf and write_obj). There is one page then, without an image,
  // and its `indices` are the scene's, corner by corner. Must outlive the writing.
  const Scene* scene = nullptr;
};

struct WorldFile {
  std::int64_t bytes = 0;                            // written, all files of the world but images
  std::size_t triangles = 0, vertices = 0, uvs = 0;  // as written: each page has its own
  // Of World::scene: what of it could not be written, "2 x animations", one string a kind; and of
  // glTF the attribute that holds the new uvs.
  std::vector<std::string> not_kept = {};
  std::string uv_set = {};
  Vec3d origin_left_out;  // to be added to the coordinates written; zero but in VRML, see there
};

// Writers check the world first (bad_input: an index out of range, a non-finite or beyond-float
// number, unequal lengths), write under the temporary names of `files`, and leave committing to the
// caller, so that a world and its images appear together or not at all. Numbers are the shortest
// decimals that read back to the same float (double, where the origin is not 0), so equal positions
// are equal text. Other errors: io; cancelled.

// VRML97, gzipped where the name ends in .wrz. World::scene is refused (bad_option). One Shape a
// page: an IndexedFaceSet of triangles with explicit texCoordIndex, unlit (no Material) unless no
// page has an image, repeat off, two-sided. Viewers hold single floats: an origin more than 128
// times the world's size from zero is not added but noted in WorldInfo, where read_scene() finds
// it.
Result<WorldFile> write_vrml(const World& world, const std::filesystem::path& path,
                             AtomicFiles& files, const Context& context);

// A line of WorldInfo in worlds whose z axis points up, which VRML itself has no word for.
inline constexpr const char* kZUpNote = "the z axis points up";

// Wavefront OBJ and, beside it, an MTL of the same name with one material `page<i>` a page.
// World::scene: its objects (`o`), materials (names, all made different, Kd, and what else their
// MTL said), normals and light; the format has one set of uvs, which are the new ones, so the
// scene's are left out and lines that name textures become comments.
Result<WorldFile> write_obj(const World& world, const std::filesystem::path& path,
                            AtomicFiles& files, const Context& context);

// glTF 2.0: .glb with everything embedded, or .gltf with a .bin beside it. Materials with an
// image are KHR_materials_unlit; the root node turns the scene's up to +Y, scales to metres and
// adds the origin, since glTF fixes both.
//
// World::scene with a source (Scene::source): that file again, its nodes, materials, attributes,
// skins and animations as they are, with the new uvs in the first set behind TEXCOORD_0 that
// nothing in it has (sets that a primitive lacks before that are the new one, too). What nodes show
// several times has a mesh for each. A scene whose triangles or positions are not those of its
// source is refused (bad_input).
// World::scene without one: a node and a mesh an object, a primitive a material, with NORMAL, the
// scene's own uvs as TEXCOORD_0 and the new ones as TEXCOORD_1 (as both where it has none), its
// light as COLOR_0 (_ILLUMINANCE, where it leaves 0..1); materials have base colours with their
// textures, and what is seen through them; no camera. Root nodes are the objects themselves where
// nothing is to be turned, scaled or moved.
Result<WorldFile> write_gltf(const World& world, const std::filesystem::path& path,
                             AtomicFiles& files, const Context& context);

// One of these, by the extension of `path`; check_world_extension() refuses all other extensions
// (bad_option).
Result<WorldFile> write_world(const World& world, const std::filesystem::path& path,
                              AtomicFiles& files, const Context& context);
Status check_world_extension(const std::filesystem::path& path);

// Whether a world of this extension can keep World::scene; others are refused (bad_option).
bool holds_scene(const std::filesystem::path& path);

// The image file that write_gltf() makes of a texture of World::scene beside the .gltf `target`:
// NAME_texture<i>.png or .jpg.
std::filesystem::path scene_texture_path(const Scene& scene, std::size_t texture,
                                         const std::filesystem::path& target);

// Whether a world of this extension says where a viewer starts; the others ignore
// World::viewpoint, which need not be chosen for them.
bool holds_viewpoint(const std::filesystem::path& path);

// The check that writers begin with.
Status check_world(const World& world);

// A file name of letters, digits, '_', '-' and '.' only, made from any text: what all viewers can
// load. Texts of other characters get different names nearly always.
std::string safe_file_name(const std::string& text);

}  // namespace atlas
