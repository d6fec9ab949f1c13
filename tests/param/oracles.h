// Slow reference results by independent methods, for comparison.
#pragma once

#include <span>
#include <vector>

#include "libatlas/param/local_mesh.h"

namespace atlas::testing {

// Returns whether all triangles are positive in uv and no two of them share an inner point.
// Intersects every pair with CGAL's exact constructions, in O(n²).
bool injective_by_pairs(const LocalMesh& mesh, std::span<const Vec2d> uvs);

// Returns the energy that the isometric descent lowers: the sum over triangles of area times (p² +
// q²) / 2 - f(q), computed from the singular values of Eigen's decomposition. Here p = s1 + s2 - 2,
// q = s1 - s2, s2 is negative if the triangle is flipped, and f is what LocalStep's shear weight
// spares.
double isometric_energy(const LocalMesh& mesh, std::span<const Vec2d> uvs, double shear_weight);

// The same with weight 1, the ARAP energy: the sum of area * |J - R|² with the best rotation R of
// each triangle, where |J - R|² = (s1 - 1)² + (s2 - 1)².
double arap_energy(const LocalMesh& mesh, std::span<const Vec2d> uvs);

// Flattens a disc with CGAL's ARAP parameteriser (lambda 0: no similarity term). Returns an empty
// result if it fails. Available only if CGAL's headers are installed.
bool cgal_parameterizers_built();
std::vector<Vec2d> cgal_arap(const LocalMesh& mesh, unsigned iterations);

}  // namespace atlas::testing
