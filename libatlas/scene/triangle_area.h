// Internal: computes the area of a scene's triangle in double precision, so that the areas of small
// scenes do not vanish.
#pragma once

#include <glm/geometric.hpp>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/scene/scene.h"

namespace atlas {

inline double triangle_area(const Scene& scene, std::size_t triangle) {
  const std::uint32_t* v = &scene.indices[3 * triangle];
  const glm::dvec3 a = to_dvec(scene.positions[v[0]]);
  return 0.5 * glm::length(glm::cross(to_dvec(scene.positions[v[1]]) - a,
                                      to_dvec(scene.positions[v[2]]) - a));
}

}  // namespace atlas
