// Internal: orthogonal projection, the cheapest flattening, with a bound on the stretch that is
// known beforehand.
#pragma once

#include <span>

#include "libatlas/core/vec.h"
#include "libatlas/param/local_mesh.h"

namespace atlas {

// Projects along `axis` (any length > 0) onto the plane perpendicular to it, right-handed seen from
// the axis's tip: a triangle whose normal is within 90 degrees of the axis keeps its orientation.
// uvs.size() must be positions.size(); any set of triangles will do. A triangle whose normal makes
// the angle a with the axis has exactly s1 = 1 / cos a and s2 = 1, so at the projection's own scale
// the stretch is at most 1 / cos(cone angle). The area-preserving scale lies between, so max(s1,
// 1/s2) stays within 1 / cos(cone angle) at that scale, too.
void project_planar(const LocalMesh& mesh, Vec3d axis, std::span<Vec2d> uvs);

// Returns the largest 1 / cos a over the triangles with area, which is the bound above; infinite if
// the normal of any is at 90 degrees or more to the axis.
double planar_stretch_bound(const LocalMesh& mesh, Vec3d axis);

// Returns the signed area of that projection as a share of the surface area; 1 if there is no area.
// At the area-preserving scale some triangle has at least the stretch 1 / sqrt(share).
double projected_share(const LocalMesh& mesh, Vec3d axis);

// Returns the unit direction of the area-weighted mean normal; (0, 0, 1) if that vanishes.
Vec3d mean_normal(const LocalMesh& mesh);

}  // namespace atlas
