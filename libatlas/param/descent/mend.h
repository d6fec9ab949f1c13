// Internal: mends single triangles that are ruined, though their chart is within its bound.
#pragma once

#include "libatlas/param/descent/arap_solver.h"
#include "libatlas/param/parameterize.h"

namespace atlas::param {

// The bound leaves out 0.1 % of a chart's area. Triangles there may be squeezed a hundredfold, so
// that hardly a texel is left to them, and one alone may raise the L2 stretch by a hundredth. If
// there are such triangles, this smooths the places around them, as far as the bound and the border
// allow. The result is kept only if both the largest and the L2 stretch are lower. `r` must be
// judged; if it is not injective and within the bound, nothing happens.
void mend_ruined(const LocalMesh& mesh, const ParamOptions& options, ArapSolver& solver,
                 ParamResult& r);

}  // namespace atlas::param
