// Internal: grains, the small patches of triangles that cells are grown from.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/charts/cells/cells.h"
#include "libatlas/charts/mesh/topology.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {

// Grains: small patches of triangles. They form the graph on which seeds are chosen.
struct Grains {
  std::vector<std::uint32_t> of_triangle;
  std::vector<glm::vec3> centroid, normal;
  std::vector<float> area;
  std::vector<std::uint32_t> size;       // number of triangles
  std::vector<std::uint32_t> component;  // its piece; ascending, so the grains of a piece are
                                         // contiguous
  std::vector<std::uint32_t> first, neighbour;  // compressed rows
  std::vector<float> distance;                  // one per neighbour: between the centroids
  std::size_t count() const { return area.size(); }
};

inline glm::vec3 centroid(const Topology& topology, std::uint32_t t) {
  const std::uint32_t* v = &topology.corner_vertex[3 * std::size_t{t}];
  return (to_glm(topology.points[v[0]]) + to_glm(topology.points[v[1]]) +
          to_glm(topology.points[v[2]])) *
         (1.0f / 3.0f);
}

// Grows grains breadth-first, about twelve per cell. The normals of a grain's triangles are within
// 45 degrees of that of its first triangle.
Grains grow_grains(const CellInput& input);

}  // namespace atlas
