// Reads illuminated scenes: OBJ + MTL, PLY, OFF, STL, glTF 2.0 and GLB, and worlds written by
// exporters/.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/scene/defects.h"
#include "libatlas/scene/scene.h"
#include "libatlas/scene/uv_page.h"

namespace atlas {

struct ReadOptions {
  double metres_per_unit = 1;  // length of one unit of the file, > 0
  // If not empty, the illumination is taken from this file instead: OBJ, PLY, OFF or glTF with the
  // same vertices in the same order, or plain text with one `r g b` (or one grey value) per line.
  std::filesystem::path illumination_file = {};
  // true: values of vertices within 0..1 are sRGB-encoded colours, as scanners and modellers write
  // them, and are decoded: Scene::illumination is linear in any case. PLY illuminance_r/g/b and
  // glTF are linear by their definition, and stay as they are.
  bool srgb_colours = false;
  // false: materials only have their diffuse colour, and glTF files may require formats of textures
  // that are not read, unless `rest` is set
  bool load_textures = true;
  bool unlit_textures = true;  // false: the same if the scene carries no illumination
  // Keeps PNG and JPEG textures encoded, in Texture::encoded, for programs that only pass them on.
  bool encoded_textures = false;
  bool normals = false;   // true: reads the file's normals into Scene::normals
  bool polygons = false;  // true: keeps which triangles are one face, in Scene::polygons
  // Keeps what Scene has no arrays for, in Scene::source (glTF) and Material::mtl_lines (OBJ), and
  // reads Scene::vertex_opacity (alpha of PLY's and OFF's vertices and of glTF's COLOR_0). All
  // images of a glTF file are then textures, in the file's order, except those in formats of
  // extensions (EXT_texture_webp) that no base colour needs, or that cannot be decoded: the source
  // holds their files. Scene::not_read counts what the arrays lack in any case. An export to glTF
  // refuses a scene with a source whose positions have been changed, see Scene::source.
  bool rest = false;
  // Reads the lightmap that a file names as libatlas writes it (glTF in asset.extras.lightmap, OBJ
  // in a comment) into Scene::lightmap: its linear images if all can be read, else those of 8 bits.
  // Ignored if there is an illumination_file.
  bool lightmap = false;
  // true: of several sets of uvs, takes the last whose page a glTF file says as libatlas writes it,
  // such as those of an earlier export, in place of those of the materials' textures.
  bool told_uvs = false;
  // If true, sets encoded_textures, normals and rest, which exports that keep the scene need.
  bool keep_scene = false;
  // true: a scene may name only files in its own folder and below, after links are followed, and is
  // refused if it would be read with another one. A file that is not where its name says may still
  // be taken from beside the file that names it. The scene itself and the illumination file may lie
  // anywhere; each has a folder of its own.
  bool confine = false;
  // false: what a small file may unpack to, repeat or show by reference has no limit in proportion
  // to its size, and polygons are cut whatever time that takes. docs/formats.md lists the limits.
  bool limits = true;
};

// Where a viewer of a file begins, in the coordinates of the file.
struct FileView {
  Vec3d position = {};
  Vec3d direction = {0, 0, -1};  // unit length
  std::string name = {};         // as the file calls it; empty: not at all
};

struct LoadedScene {
  Scene scene = {};
  DefectReport defects = {};  // what was left out or replaced
  // Files that were read besides the scene's own and the illumination file: material libraries,
  // buffers, textures, images of lightmaps, also those that could not be decoded. Missing files are
  // not listed.
  std::vector<std::filesystem::path> files = {};
  // Existing files that the scene names, but that were not read: textures that the options leave
  // out or that no triangle uses, other maps of materials, and files that are not supported.
  // Programs must not write over them.
  std::vector<std::filesystem::path> unread_files = {};
  // Width / height of the pages that the uvs were made for, if an OBJ, glTF or VRML file says so as
  // libatlas writes it (scene/uv_page.h) and all pages have one shape; else 0.
  double uv_aspect = 0;
  // The same, one per material of the scene, if the pages differ in shape (then 1 for a material of
  // which the file says nothing); else empty. For ChartOptions::material_uv_aspects.
  std::vector<double> material_uv_aspects = {};
  // One per material of the scene: its page, likewise; and all pages that the file names.
  std::vector<UvPage> material_uv_pages = {}, uv_pages = {};
  // The first Viewpoint of a VRML file, or the first perspective camera of a glTF file's scene.
  std::optional<FileView> view = {};
  std::vector<FileView> further_views = {};  // the others, in the order of the file, at most 100
};

// Reads the scene at `path`; the extension (.obj .ply .off .stl .gltf .glb .wrl .wrz, any case)
// chooses the format.
//
// Positions are parsed in double precision. If the centre of the bounding box of the used vertices
// is farther from 0 than the length of the box's diagonal, Scene::origin is that centre, rounded to
// a multiple of a quarter of the diagonal's next larger power of two, and positions are stored
// relative to it. Otherwise the origin is 0 and positions are the file's own, rounded to float. If
// rounding then moves used vertices by more than 1e-3 of the typical edge (the median of the
// triangles' longest), and fewer of them with an origin near the median of the used vertices, that
// is the origin, rounded likewise to a quarter of a power of two. What is moved so far all the same
// is a defect.
// Materials and objects without a triangle are not listed; the others are listed in the order of
// first use.
// Illumination is read from OBJ `v x y z r g b`; PLY red/green/blue, r/g/b or illuminance_r/g/b
// (unsigned integers of 8 and 16 bits are normalised); the colours of COFF; glTF _ILLUMINANCE, else
// COLOR_0. Values are never clamped, and decoded only if ReadOptions::srgb_colours says so. Normals
// are read from OBJ vn; PLY nx, ny, nz; NOFF; glTF NORMAL, transformed by its node, skin and morph
// targets.
//
// Errors: not_found (no such file, no such buffer); bad_input (malformed as scene/defects.h defines
// it; no usable triangle; an illumination file with another number of vertices; a file outside the
// scene's folder, see ReadOptions::confine); unsupported (unknown extension; glTF that requires an
// extension which is not read; beyond ReadOptions::limits; more than the memory holds); bad_option;
// cancelled.
Result<LoadedScene> read_scene(const std::filesystem::path& path, const ReadOptions& options,
                               const Context& context);

}  // namespace atlas
