// Orthogonal projection: the cheapest flattening, with a bound known beforehand.
#pragma once

#include <span>
#include <vector>

#include "libatlas/core/vec.h"
#include "libatlas/param/local_mesh.h"

namespace atlas {

// Projects along `axis` (any length > 0) onto the plane it is normal to; right-handed seen from the
// axis's tip, so a triangle whose normal lies within 90 degrees of the axis keeps its orientation.
// uvs.size() == positions.size(); any set of triangles.
// A triangle whose normal makes the angle a with the axis has s1 = 1 / cos a and s2 = 1 exactly: at
// the projection's own scale the stretch is at most 1 / cos(cone angle). The area-preserving scale
// lies between, hence at that scale max(s1, 1/s2) stays within 1 / cos(cone angle), too.
void project_planar(const LocalMesh& mesh, Vec3d axis, std::span<Vec2d> uvs);

// The largest 1 / cos a over the triangles that have an area, infinite if one stands at 90 degrees
// or more to the axis: the bound of the sentence above.
double planar_stretch_bound(const LocalMesh& mesh, Vec3d axis);

// The signed area of that projection, as part of the surface's: at the area-preserving scale the
// stretch of some triangle is at least the root of its inverse. 1 where there is no area.
double projected_share(const LocalMesh& mesh, Vec3d axis);

// The unit direction of the area-weighted mean normal; (0, 0, 1) where that vanishes.
Vec3d mean_normal(const LocalMesh& mesh);

}  // namespace atlas
