// The exporters, and what they write: a textured, unlit mesh whose textures are the atlas pages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"
#include "libatlas/files/atomic_file.h"
#include "libatlas/files/safe_file_name.h"
#include "libatlas/unwrap/instance.h"

namespace atlas {

struct Scene;  // libatlas/scene/scene.h

enum class Up { y, z };

// Where a viewer starts, in the coordinates of World::positions, that is, relative to the origin.
struct Viewpoint {
  Vec3d position = {};
  Vec3d direction{0, 0, -1};  // of view; not zero, not along the up axis
  double fov = 1.0;           // radians, in (0, pi); of the smaller side of the window
  // Whether the scene surrounds the viewpoint: viewers then walk, otherwise they turn the object.
  bool inside = false;
};

struct NamedViewpoint {
  std::string name = {};  // empty: it has none
  Viewpoint viewpoint = {};
};

struct Page {
  std::string image = {};  // file name beside the world, see safe_file_name(); empty: no texture
  // Path of the finished image while the world is written, .png or, in glTF and .html, .webp. Only
  // .glb and .html need it, to embed the image.
  std::filesystem::path image_source = {};
  std::vector<std::uint32_t> indices = {};     // 3 per triangle, into World::positions
  std::vector<std::uint32_t> uv_indices = {};  // 3 per triangle, into World::uvs
  // Only .obj: the corners of each face, at least 3; empty: all are triangles. The two lists above
  // then have the corners of one face after the other.
  std::vector<std::uint32_t> face_sizes = {};
  // 1 per triangle, or empty: whether it is seen from its front only, where its corners run
  // counter-clockwise. All others are seen from both sides. OBJ cannot tell them apart.
  std::vector<bool> one_sided = {};
  // Only .html shows the following. The chart of each triangle, or empty.
  std::vector<std::uint32_t> charts = {};
  // The root mean square error of display values, 0..1, in cells of equal size that divide the page
  // into error_columns x rows, row 0 at the bottom; below 0 where it is unknown. Empty: not
  // measured.
  std::vector<float> error = {};
  std::size_t error_columns = 0;
};

// One of the curves that show pages of light, as numbers of ToneMapping (texture/tone.h).
struct ShownCurve {
  std::string name = {};  // tone_operator_name()
  double scale = 1, white = 1;
  double parameter[4] = {0, 0, 0, 0};
  double offset[3] = {0, 0, 0};
};

// What pages mean that hold the light itself (see html/light_page.h) instead of display values.
struct PageLight {
  // What the scene's vertices carry: "illuminance" (lx), then the pages hold it times the
  // reflectance; "luminance" (cd/m²) or "colour", then the pages hold just that.
  std::string quantity = {};
  std::vector<ShownCurve> curves = {};  // at least one; the first is shown at the beginning
  // Of each chart: its diffuse reflectance, or 0 where a texture or several materials vary it.
  std::vector<Vec3f> reflectance = {};
};

// The pages with the light of a scene that is kept, addressed by the world's uvs.
struct Lightmap {
  // File names beside the world, one a page: .png or .webp files, sRGB-encoded, and if asked for
  // .exr files of the light itself.
  std::vector<std::string> images = {}, linear = {};
  // The light that the former show as white, in the unit of Scene::illumination; 0: it does not
  // grow in proportion to light, because a tone curve bends it.
  double white = 0;
  std::vector<std::uint32_t> triangle_page = {};  // 1 per triangle; empty: all are on the first
};

struct World {
  Vec3d origin = {};                  // added to every position to get the coordinates of the file
  double metres_per_unit = 1;         // > 0
  Up up = Up::y;                      // the scene's up axis; coordinates are written unchanged
  std::vector<Vec3f> positions = {};  // finite; shared by all pages
  std::vector<Vec2f> uvs = {};        // finite, 0..1, origin bottom left
  std::vector<Page> pages = {};
  // The UDIM tile of each uv, counted from 0 (tile 1001); empty: all are in the first. A uv of tile
  // n > 0 is written as (u + n mod 10, v + n / 10), with ten decimals. Only OBJ has tiles.
  std::vector<std::uint32_t> uv_tiles = {};
  std::string title = {};
  std::vector<std::string> info = {};  // one line each, for WorldInfo and comments
  Viewpoint viewpoint = {};
  std::vector<NamedViewpoint> further_viewpoints = {};  // offered by .html
  // If not null: the scene that the uvs are for. It is written with its own objects, materials,
  // normals and texture coordinates (see write_gltf and write_obj). The world then has one page,
  // without an image, whose `indices` are those of the scene, corner by corner. The scene must
  // outlive the writing.
  const Scene* scene = nullptr;
  // For `scene` in glTF: the new uvs become the set TEXCOORD_<uv_set>, 1..7, in place of what it
  // holds. 0: the first set that is free. OBJ has one set and ignores this.
  int uv_set = 0;
  // For `scene` that was read from glTF, in glTF: each mesh is written once, however often it is
  // shown, with the uvs of its first place, which are 0..1 over a square of its own. One for each
  // place of a mesh, in the order in which the file's nodes show them: where that square lies on
  // the pages, which extras of nodes and attributes of instances then say. Empty: nowhere.
  std::optional<std::vector<MeshInstance>> instances = {};
  // For glTF: packs attributes and indices (EXT_meshopt_compression). In a world without `scene`,
  // positions become whole numbers of 16 bits (KHR_mesh_quantization) if that moves none by more
  // than this, in scene units, along an axis, and so do uvs of pages with images. Empty: plain.
  std::optional<double> compress_slip = {};
  // For `scene`: with a lightmap, vertices are written without light, by which viewers would
  // multiply it. glTF names it as asset.extras.lightmap (images, linear, texCoord and white), and
  // the page of a primitive, if there are several, as its extras.lightmap. OBJ names it in a
  // comment, and has only one page.
  std::optional<Lightmap> lightmap = {};
  // Only .html: set if the pages' images are files of write_light_page().
  std::optional<PageLight> light = {};
};

struct WorldFile {
  std::int64_t bytes = 0;                            // size of all files of the world except images
  std::size_t triangles = 0, vertices = 0, uvs = 0;  // as written: each page has its own
  // For World::scene: what could not be written, one string per kind ("2 x animations"); and the
  // attribute that holds the new uvs ("TEXCOORD_1"; "vt" in OBJ).
  std::vector<std::string> not_kept = {};
  std::string uv_set = {};
  // For a scene of glTF in glTF: meshes that stay as they were, because the scene does not show
  // them.
  std::size_t meshes_without_uvs = 0;
  // To be added to the written coordinates; zero except in VRML, see there.
  Vec3d origin_left_out = {};
  // Only glTF: whether the world is so far from zero that a node of its own, kFarOriginNode, adds
  // the origin.
  bool far_origin = false;
};

// Writers check the world first (bad_input: an index out of range, a number that is not finite or
// beyond float, lists of unequal length, tiles in a format that has none). They write under the
// temporary names of `files` and leave committing to the caller, so that a world and its images
// appear together or not at all. Numbers are the shortest decimals that read back to the same float
// (or double, if the origin is not 0), so equal positions are equal text. Other errors: io,
// cancelled.

// Writes VRML97, gzipped if the name ends in .wrz. World::scene is refused (bad_option). Each page
// is a Shape: an IndexedFaceSet of triangles with explicit texCoordIndex, unlit (no Material)
// unless no page has an image, with textures that do not repeat, two-sided. Page::one_sided become
// a Shape of their own that is `solid TRUE`. Viewers hold single floats: an origin farther from
// zero than 128 times the world's size is not added but noted in WorldInfo, where read_scene()
// finds it.
Result<WorldFile> write_vrml(const World& world, const std::filesystem::path& path,
                             AtomicFiles& files, const Context& context);

inline constexpr const char* kFarOriginNode = "origin";

// The line of WorldInfo in VRML, and the comment in OBJ, that marks a world whose z axis points up;
// the formats have no property for it.
inline constexpr const char* kZUpNote = "the z axis points up";

// Writes a Wavefront OBJ file and, beside it, an MTL file (named by safely_beside()) with one
// material `page<i>` per page; those with an image say that nothing lights them (`illum 0`).
// World::scene is written with its objects (`o`), materials (with unique names,
// Kd, and the other lines of their MTL), normals and light. The format has only one set of uvs,
// which holds the new ones, so the scene's own are left out, and lines that name textures become
// comments.
Result<WorldFile> write_obj(const World& world, const std::filesystem::path& path,
                            AtomicFiles& files, const Context& context);

// Writes glTF 2.0: a .glb with everything embedded, or a .gltf with a .bin beside it. Materials
// with an image (a .webp by EXT_texture_webp, which viewers then must know) are KHR_materials_unlit
// and double-sided, except for those of Page::one_sided, which are primitives of their own; the
// root node turns the scene's up axis to +Y, scales to metres and adds the origin, since glTF
// prescribes axis and unit. An origin farther from zero than 128 times the world's size is added by
// a node above all others, kFarOriginNode: engines that hold single floats need it moved to zero.
//
// If World::scene has a source (Scene::source), that file is written again: its nodes, materials,
// attributes, skins and animations stay as they are. The new uvs are in World::uv_set, else in the
// first set after TEXCOORD_0 that no primitive shown has (sets before it that a primitive lacks
// refer to the new uvs, too). A mesh that nodes show several times is written once for each. A
// scene is refused (bad_input) if the number of its triangles, the range of positions that they
// use, or a position or its origin is not that of its source. Other members of the scene are not
// written; see Scene::source for programs that change them.
//
// If World::scene has no source, each object becomes a node and a mesh, and each material a
// primitive, with NORMAL, the scene's own uvs as TEXCOORD_0 and the new ones as TEXCOORD_1 (as both
// sets if it has none; with a higher World::uv_set, all sets from TEXCOORD_1 on), and its light as
// COLOR_0 (or _ILLUMINANCE, if values leave 0..1), with the vertices' opacity as its alpha.
// Materials keep base colours with their textures, opacity and emission, and stay unlit. There is
// no camera. The root nodes are the objects if nothing must be turned, scaled or moved.
Result<WorldFile> write_gltf(const World& world, const std::filesystem::path& path,
                             AtomicFiles& files, const Context& context);

// Writes a page of HTML that shows the world in a browser by itself: geometry, pages and viewer are
// in this one file, which loads nothing. World::scene is refused (bad_option). Positions are
// rounded to a 64th of a millimetre where the viewpoint is inside, else to a 65535th of the box;
// uvs to a 32nd of a texel of 2048. docs/formats.md describes the data, which scripts can read as
// well.
Result<WorldFile> write_html(const World& world, const std::filesystem::path& path,
                             AtomicFiles& files, const Context& context);

// Calls the writer for the extension of `path`. check_world_extension() refuses extensions that
// have no writer (bad_option).
Result<WorldFile> write_world(const World& world, const std::filesystem::path& path,
                              AtomicFiles& files, const Context& context);
Status check_world_extension(const std::filesystem::path& path);

// Returns whether a world of this extension can be compressed and can have images of WebP.
bool holds_compressed(const std::filesystem::path& path);

// Returns whether a world of this extension can keep World::scene; the writers of the others refuse
// it (bad_option).
bool holds_scene(const std::filesystem::path& path);

// Returns the image files that write_gltf() makes of a scene's textures, if `target` is a .gltf:
// NAME_texture<i>.png or .jpg, where i counts Scene::textures; or, of a scene that has a source,
// the images of its file. These may have the extensions of other formats.
std::vector<std::filesystem::path> scene_texture_paths(const Scene& scene,
                                                       const std::filesystem::path& target);

// Returns whether a world of this extension stores where a viewer starts. The others ignore
// World::viewpoint, which need not be chosen for them.
bool holds_viewpoint(const std::filesystem::path& path);

// Returns whether a world of this extension holds its images itself: none is written beside it.
bool embeds_images(const std::filesystem::path& path);

// Returns whether a world of this extension can hold pages of light (World::light).
bool holds_light(const std::filesystem::path& path);

// Returns the file that is written beside the world besides images, .mtl or .bin; empty if there is
// none.
std::filesystem::path file_beside(const std::filesystem::path& path);

// The check that all writers begin with.
Status check_world(const World& world);

// Refuses a world of UDIM tiles or of faces with more corners, for formats that have none.
Status check_only_triangles(const World& world);

// Returns the file name of a page's image without its extension: world.wrl gives world_0, world_1,
// ...
std::string page_name(const std::filesystem::path& target, std::size_t page);

}  // namespace atlas
