// CGAL's parameterization methods with a similar interface, for comparison. Only built with
// LIBATLAS_CGAL_PARAMETERIZATION: that package is under the GPL, and so is a library with it.
#pragma once

#include <span>

#include "libatlas/core/status.h"
#include "libatlas/param/local_mesh.h"

namespace atlas {

enum class CgalMethod {
  arap,  // CGAL's as-rigid-as-possible parameterization without a similarity term
  lscm,  // least squares conformal maps
};

bool cgal_backend_built();

// Writes uvs (one per vertex), scaled to the surface's area. The mesh must be a disc without
// degenerate triangles; density is ignored. Errors: unsupported (not built), no_solution (with
// CGAL's message).
Status cgal_parameterize(const LocalMesh& mesh, CgalMethod method, std::span<Vec2d> uvs);

}  // namespace atlas
