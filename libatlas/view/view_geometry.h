// Internal: normals, spheres and boxes of scenes that are drawn.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "libatlas/view/view_scene.h"

namespace atlas {

// Returns the normal of a corner: the area-weighted mean of the faces at its vertex whose normals
// are within the crease angle of its own face's. Faces of opposite winding are flipped first.
// `corners_there` are the corners at the vertex, 3 per triangle, and `faces` the area-weighted
// normals of all triangles, of which `own` is the corner's.
glm::vec3 corner_normal(std::span<const std::uint32_t> corners_there,
                        const std::vector<glm::vec3>& faces, std::uint32_t own, float least_cosine);

// Returns a Morton code of 30 bits for a point whose coordinates are 0 to 1023.
std::uint32_t morton_code(const glm::dvec3& point);

// Returns the box of positions without the outermost 5 % at each end of each axis: the part of a
// scene that has detail, without the ground or sky around it.
Box3 middle_of(const std::vector<Vec3f>& positions);

// Computes the cluster's sphere, around the centre of its box.
void enclose(const ViewScene& view, ViewScene::Cluster& cluster);

}  // namespace atlas
