// Internal: a mesh in an order of its own. Charts break ties by id, so the order of ids has to
// follow from the surface, not from the file.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/charts/mesh/weld.h"

namespace atlas {

// The same triangles whatever the order of the input's triangles and vertices is, and whichever
// corner of a triangle comes first.
struct CanonicalMesh {
  std::vector<std::uint32_t> first_corner;  // one per triangle: its first corner in the input
  WeldedVertices places;                    // in the order in which triangles name them
  std::vector<std::uint32_t> indices;       // of places
  std::vector<std::uint32_t> opposite;      // one per corner, see pair_links()
  std::vector<std::uint32_t> materials, texcoord_indices;
  std::vector<float> density;
  std::vector<std::uint8_t> seams;
  std::vector<std::uint32_t> polygons;
  std::vector<float> seam_weights;  // one per place

  // Without positions, which are those of the places.
  MeshView view(std::span<const Vec2f> texcoords) const {
    return {{},    indices, materials, density,     texcoords, texcoord_indices,
            seams, {},      polygons,  seam_weights};
  }
  std::uint32_t input_triangle(std::uint32_t t) const { return first_corner[t] / 3; }
  std::uint32_t input_corner(std::uint32_t corner) const {
    const std::uint32_t first = first_corner[corner / 3];
    return first - first % 3 + (first % 3 + corner % 3) % 3;
  }
};

// Triangles are numbered in the order in which a walk over the surface reaches them, from one edge
// and then across the edges of each triangle in turn. Positions matter only for where walks begin:
// at an edge whose surroundings are like no other's, first by how triangles are joined, then by
// their sizes, and last by coordinates. Rotations and small changes therefore keep the order, and
// powers of two change nothing. Of edges that are alike in all of this, either may be the first.
// Takes linear time, except for a sort of the pieces. `welded` is that of the input's positions.
CanonicalMesh canonical_mesh(const MeshView& input, const WeldedVertices& welded);

}  // namespace atlas
