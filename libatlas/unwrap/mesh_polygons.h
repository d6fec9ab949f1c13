// Internal: polygons of a mesh as triangles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/polygon.h"
#include "libatlas/core/status.h"
#include "libatlas/unwrap/atlas.h"

namespace atlas {

// The triangles of a mesh of polygons, with what the mesh says of its polygons and their corners.
struct TriangulatedMesh {
  PolygonCorners polygons;
  std::vector<std::uint32_t> indices, texcoord_indices, materials;
  std::vector<float> density;
  std::vector<std::uint8_t> seams;

  // `mesh` is what was triangulated. Both must outlive the view.
  StridedMesh view(const StridedMesh& mesh) const;
};

// `mesh` has polygon sizes and has passed check_mesh(). Errors, with the number of mesh and
// polygon: bad_input for a polygon that names its vertices over and over, unsupported for an
// outline too intricate to be triangulated (see triangulate()).
Result<TriangulatedMesh> triangulate_mesh(const StridedMesh& mesh, std::size_t number);

// Returns the seams of the polygons' sides, one per corner, from those of the triangles'
// half-edges.
std::vector<std::uint8_t> seams_of_sides(std::span<const std::uint8_t> seams,
                                         const PolygonCorners& polygons);

}  // namespace atlas
