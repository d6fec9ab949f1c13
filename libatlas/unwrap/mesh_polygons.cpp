#include "libatlas/unwrap/mesh_polygons.h"

#include <fmt/format.h>

#include <array>
#include <span>

#include "libatlas/core/half_edge.h"
#include "libatlas/core/no_index.h"

namespace atlas {
namespace {

// Fills `polygons`.
Status cut_polygons(const StridedMesh& mesh, std::size_t number, PolygonCorners& polygons) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::int64_t> vertices;
  std::vector<Vec3d> corners;
  std::size_t first = 0;
  for (const std::uint32_t size : mesh.polygon_sizes) {
    vertices.clear();
    corners.clear();
    for (std::size_t i = first; i < first + size; ++i) {
      const Vec3f p = mesh.positions[mesh.indices[i]];
      vertices.push_back(mesh.indices[i]);
      corners.push_back({double{p.x}, double{p.y}, double{p.z}});
    }
    const auto bad = [&](ErrorCode code, const char* text) {
      return Status(code, fmt::format("mesh {}: polygon {}: {}", number, polygons.count(), text));
    };
    if (goes_round_and_round(vertices))
      return bad(ErrorCode::bad_input, "it names its vertices over and over (give an outline)");
    if (!triangulate(corners, triangles))
      return bad(ErrorCode::unsupported,
                 "its outline is too intricate to cut it into triangles (divide it)");
    polygons.add(size, triangles);
    first += size;
  }
  return {};
}

template <class T>
std::vector<T> per_triangle(std::span<const T> values, const PolygonCorners& polygons) {
  std::vector<T> out;
  if (values.empty()) return out;
  for (const std::uint32_t p : polygons.polygon) out.push_back(values[p]);
  return out;
}

// Sides of the polygons keep what is said of them; edges inside are no seams.
std::vector<std::uint8_t> seams_of_triangles(std::span<const std::uint8_t> seams,
                                             const PolygonCorners& polygons) {
  std::vector<std::uint8_t> out;
  for (std::uint32_t h = 0; !seams.empty() && h < polygons.triangles.size(); ++h) {
    const std::uint32_t side = side_of(polygons, h);
    out.push_back(side == kNoIndex ? std::uint8_t{0} : seams[side]);
  }
  return out;
}

}  // namespace

std::vector<std::uint8_t> seams_of_sides(std::span<const std::uint8_t> seams,
                                         const PolygonCorners& polygons) {
  std::vector<std::uint8_t> sides(polygons.first.back(), 0);
  for (std::uint32_t h = 0; h < seams.size(); ++h) {
    const std::uint32_t side = side_of(polygons, h);
    if (side != kNoIndex) sides[side] = seams[h];
  }
  return sides;
}

StridedMesh TriangulatedMesh::view(const StridedMesh& mesh) const {
  StridedMesh triangles = mesh;
  triangles.indices = {indices.data(), indices.size(), 4};
  triangles.texcoord_indices = {texcoord_indices.data(), texcoord_indices.size(), 4};
  triangles.materials = materials;
  triangles.density = density;
  triangles.seams = seams;
  triangles.polygons = polygons.polygon;
  triangles.polygon_sizes = {};
  return triangles;
}

Result<TriangulatedMesh> triangulate_mesh(const StridedMesh& mesh, std::size_t number) {
  TriangulatedMesh out;
  if (Status s = cut_polygons(mesh, number, out.polygons); !s.ok()) return s;
  for (const std::uint32_t corner : out.polygons.triangles) {
    out.indices.push_back(mesh.indices[corner]);
    if (mesh.texcoord_indices.count > 0)
      out.texcoord_indices.push_back(mesh.texcoord_indices[corner]);
  }
  out.materials = per_triangle(mesh.materials, out.polygons);
  out.density = per_triangle(mesh.density, out.polygons);
  out.seams = seams_of_triangles(mesh.seams, out.polygons);
  return out;
}

}  // namespace atlas
