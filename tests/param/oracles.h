// Slow answers by other routes, for comparison.
#pragma once

#include <span>
#include <vector>

#include "libatlas/param/local_mesh.h"

namespace atlas::testing {

// Whether all triangles are positive in uv and no two of them share an inner point: every pair
// intersected with CGAL's exact constructions, O(n²).
bool injective_by_pairs(const LocalMesh& mesh, std::span<const Vec2d> uvs);

// What the isometric descent lowers, sum over triangles of area times (p² + q²) / 2 - f(q), from
// the singular values of Eigen's decomposition: p = s1 + s2 - 2, q = s1 - s2, s2 negative if
// flipped, and f what LocalStep's shear weight spares.
double isometric_energy(const LocalMesh& mesh, std::span<const Vec2d> uvs, double shear_weight);

// The same with weight 1, the ARAP energy: area * |J - R|² with the best rotation R of each,
// |J - R|² = (s1 - 1)² + (s2 - 1)².
double arap_energy(const LocalMesh& mesh, std::span<const Vec2d> uvs);

// CGAL's ARAP parameteriser on a disc (lambda 0: no similarity term); empty if it fails. Only where
// its headers are installed.
bool cgal_parameterizers_built();
std::vector<Vec2d> cgal_arap(const LocalMesh& mesh, unsigned iterations);

}  // namespace atlas::testing
