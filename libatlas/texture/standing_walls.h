// Internal: whether something stands on a surface along an edge of it, such as a partition on the
// floors of two rooms. It need not share a vertex with the surface: modellers let walls stand on
// floors, or pass through them.
#pragma once

#include "libatlas/core/triangle_distance.h"
#include "libatlas/scene/scene.h"
#include "libatlas/sheets/triangle_tree.h"

namespace atlas {

class StandingWalls {
 public:
  struct Edge {
    glm::dvec3 from, to;
    glm::dvec3 normal;  // of the surface, unit length
  };

  // What is within `reach` of an edge (scene units) stands on it. The scene must outlive this.
  StandingWalls(const Scene& scene, double reach);

  // Returns whether triangles whose planes meet the surface at an angle of more than that of
  // `least_cosine` stand on the greater part of the edge.
  bool along(const Edge& edge, double least_cosine) const;

 private:
  Triangle3 triangle(std::uint32_t t) const;

  const Scene& scene_;
  double reach_;
  TriangleTree tree_;
};

}  // namespace atlas
