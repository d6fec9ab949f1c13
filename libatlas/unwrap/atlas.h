// Unwraps several meshes onto one atlas; each gets vertices to draw with of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/polygon.h"
#include "libatlas/unwrap/instance.h"
#include "libatlas/unwrap/strided.h"
#include "libatlas/unwrap/unwrap.h"
#include "libatlas/uvs/polygon_uvs.h"

namespace atlas {

// A mesh as programs keep it to draw or to edit it: several attributes in one array, indices of 16
// bits, polygons. Members that are not explained here are those of MeshView.
struct StridedMesh {
  StridedSpan<Vec3f> positions = {};
  IndexSpan indices = {};  // 3 a triangle
  // 1 a position, or none. Edges at which triangles that share them have different normals are
  // seams then, as baked normal maps need them. Flat shading makes seams of all edges that bend.
  StridedSpan<Vec3f> normals = {};
  StridedSpan<Vec2f> texcoords = {};
  IndexSpan texcoord_indices = {};
  std::span<const std::uint32_t> materials = {};
  std::span<const float> density = {};
  std::span<const std::uint8_t> seams = {};
  std::span<const std::uint32_t> objects = {};
  std::span<const float> seam_weights = {};
  std::span<const std::uint32_t> polygons = {};  // not with polygon_sizes
  // The corners of each polygon, at least 3; or empty: all are triangles. Sizes, not offsets, since
  // files and editors have them, and every list of sizes that adds up is a valid one. `indices`,
  // `texcoord_indices` and `seams` then have one value a corner, polygon after polygon, and
  // `materials` and `density` one a polygon. Outlines may be concave, cross themselves, come back
  // to a corner, and enclose holes that are joined to them by an edge there and back. They are cut
  // as the readers of files cut them; no seam runs inside a polygon, unless it cannot lie flat in
  // one piece, see UnwrappedAtlas::Mesh::cut_polygons.
  std::span<const std::uint32_t> polygon_sizes = {};
};

// What Atlas::unwrap() returns. Where Atlas::add_instances() was called, each mesh lies in a
// rectangle of its own.
class UnwrappedAtlas {
 public:
  // Says of one mesh what UnwrappedMesh says, and triangle_chart. Pages and charts are those of the
  // atlas. Refers to the UnwrappedAtlas.
  struct Mesh {
    std::span<const std::uint32_t> vertices = {};  // into the mesh's positions
    std::span<const Vec2f> uvs = {};               // one per vertex
    std::span<const std::uint32_t> indices = {};   // three per triangle, into vertices and uvs
    std::span<const std::uint32_t> triangle_page = {}, triangle_chart = {};  // one per triangle
    // The rest is empty unless the mesh has polygons (StridedMesh::polygon_sizes). Its triangles
    // are those of its polygons, in their order, size - 2 of each.
    std::span<const std::uint32_t> triangle_polygon = {};  // one per triangle
    // One per corner of the polygons, in their own order: into vertices and uvs.
    std::span<const std::uint32_t> polygon_corners = {};
    // Polygons that a seam runs through, ascending: those that do not lie flat in one piece within
    // ChartOptions::max_stretch or cone_degrees, or that given uvs cut. Of them `polygon_corners`
    // has one part only; they are to be drawn as their triangles.
    std::span<const std::uint32_t> cut_polygons = {};
    // One per instance of a mesh that add_instances() has added: where each has `uvs`, which then
    // are 0..1 over the mesh's own rectangle. Empty: they are 0..1 over their page. triangle_page
    // is that of the first instance.
    std::span<const MeshInstance> instances = {};
  };

  std::size_t mesh_count() const { return first_vertex_.size() - 1; }
  Mesh mesh(std::size_t i) const;  // i: as Atlas::add() numbered them
  std::size_t mesh_of_chart(std::size_t chart) const;

  // All meshes: their pages, charts and placements (of an instanced mesh, those of its first
  // instance), and what was measured. Triangles and vertices are numbered through, in the order of
  // the meshes, except in `indices` and `vertices`, which are those of mesh(i), one mesh after the
  // other.
  const UnwrappedMesh& all() const { return all_; }

 private:
  friend class Atlas;
  std::span<const std::uint32_t> triangles(std::size_t i) const;  // Mesh::indices
  // `first_position`, `first_triangle`: one per mesh of `all`, and the ends.
  UnwrappedAtlas(UnwrappedMesh all, std::span<const std::size_t> first_position,
                 std::span<const std::size_t> first_triangle);

  UnwrappedMesh all_;
  std::vector<std::size_t> first_vertex_ = {}, first_triangle_ = {};  // one per mesh, and the ends
  // One per mesh, empty without polygons: the polygon of each triangle; uvs.
  std::vector<std::vector<std::uint32_t>> triangle_polygon_ = {};
  std::vector<PolygonUvs> polygon_uvs_ = {};
  std::vector<std::vector<MeshInstance>> instances_ = {};  // one per mesh, or none
};

// Meshes that are to share an atlas. They keep their order, and are never joined to each other: a
// chart holds triangles of one mesh only, also where meshes touch or lie on each other. Their
// charts get the same texel density, times `density` of add() and MeshView::density.
class Atlas {
 public:
  // Adds a copy of a mesh, whose arrays are not used afterwards. `density`: relative linear texel
  // density of the whole mesh, finite and > 0. Returns its number; meshes are counted from 0.
  // Errors: bad_input where there is no triangle; a stride, an index, a position, a density or a
  // polygon is not usable, or an array has the wrong length; unsupported where all meshes have 2^30
  // triangles or 2^32 positions, or an outline is too intricate to be cut into triangles. The
  // message names mesh and triangle or polygon, and the atlas is as it was.
  Result<std::uint32_t> add(const StridedMesh& mesh, float density = 1);
  Result<std::uint32_t> add(const MeshView& mesh, float density = 1);

  // Adds a copy of a mesh that is shown `count` times. It is unwrapped once, within a rectangle of
  // its own, and each instance gets a place for a copy of that, larger by its relative linear
  // density: one per instance, finite and > 0; empty: all 1. Charts keep the padding in the
  // smallest copy. Every other mesh of the atlas gets a rectangle of its own then, too. Errors:
  // those of add(); bad_input where there is no instance, or not one density for each; the message
  // names the instance. unsupported: 2^30 instances.
  Result<std::uint32_t> add_instances(const StridedMesh& mesh, std::size_t count,
                                      std::span<const float> densities = {});
  Result<std::uint32_t> add_instances(const MeshView& mesh, std::size_t count,
                                      std::span<const float> densities = {});

  std::size_t mesh_count() const { return first_triangle_.size() - 1; }

  // Unwraps the meshes as unwrap_mesh() would one mesh that consists of them, and may be called
  // again, with other options. Texcoords are used for ChartOptions::keep_uv_charts; meshes without
  // them get charts then, too. UnwrapOptions::like is of all meshes, not with instances. Errors:
  // those of unwrap_mesh(); bad_input where there is no mesh.
  Result<UnwrappedAtlas> unwrap(const UnwrapOptions& options, const Context& context) const;

  // Returns the seams of a mesh, in the form of MeshView::seams, or StridedMesh::seams of polygons:
  // 1 where another triangle has the same edge in space, but not in uv. `unwrapped` is what
  // unwrap() returned for these meshes. The borders of the surface are no seams. Errors: bad_input
  // (other meshes, or no such mesh).
  Result<std::vector<std::uint8_t>> seams(const UnwrappedAtlas& unwrapped, std::size_t mesh) const;

 private:
  struct SubMesh {
    std::vector<std::uint32_t> indices = {}, texcoord_indices = {};
    MeshView view = {};  // refers to these, and to the atlas
  };
  SubMesh mesh_view(std::size_t mesh) const;
  Result<UnwrappedMesh> unwrap_in_blocks(const UnwrapOptions& options, const Context& context,
                                         std::vector<std::vector<MeshInstance>>& instances) const;
  Status add_polygons(const StridedMesh& mesh, float density);
  void append(const StridedMesh& mesh, float density);
  void append_polygons(const StridedMesh& mesh);
  std::uint32_t append_positions(const StridedMesh& mesh);
  void append_seams(const StridedMesh& mesh);
  void append_texcoords(const StridedMesh& mesh);
  void cut_to_meshes();

  std::vector<std::size_t> first_position_{0}, first_triangle_{0};  // one per mesh, and the ends
  // Arrays of MeshView, which stay empty until a mesh has one.
  std::vector<Vec3f> positions_ = {};
  std::vector<std::uint32_t> indices_ = {}, materials_ = {}, texcoord_indices_ = {}, objects_ = {};
  std::vector<float> density_ = {}, seam_weights_ = {};
  std::vector<Vec2f> texcoords_ = {};
  std::vector<std::uint8_t> seams_ = {};
  std::vector<std::uint32_t> polygons_ = {};
  std::uint32_t object_count_ = 0;
  // One per mesh: its polygons, none of meshes of triangles.
  std::vector<PolygonCorners> mesh_polygons_ = {};
  // One per mesh: the densities of its instances; none: it is not instanced.
  std::vector<std::vector<float>> instances_ = {};
};

}  // namespace atlas
