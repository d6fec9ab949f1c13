// CGAL's parameterisers behind the same kind of call, for comparison. Only built with
// LIBATLAS_CGAL_PARAMETERIZATION: that package is under the GPL, and a library with it is, too.
#pragma once

#include <span>

#include "libatlas/core/status.h"
#include "libatlas/param/local_mesh.h"

namespace atlas {

enum class CgalMethod {
  arap,  // CGAL's as-rigid-as-possible parameterisation, no similarity term
  lscm,  // least squares conformal maps
};

bool cgal_backend_built();

// Writes uvs (1 a vertex), scaled to the surface's area. The mesh is a disc without degenerate
// triangles; density is ignored. Errors: unsupported (not built), no_solution (CGAL's message).
Status cgal_parameterize(const LocalMesh& mesh, CgalMethod method, std::span<Vec2d> uvs);

}  // namespace atlas
