// Finds slip and turn of a coarse mesh without shortcuts: every fine edge meets every coarse one.
#pragma once

#include <span>

#include "libatlas/simplify/simplify.h"
#include "tests/simplify/shapes.h"

namespace atlas::simplify_test {

// All are the largest over the mesh. They hold for charts that do not overlap themselves in uv.
struct ExactSlip {
  double inside = 0;  // texels: at fine vertices over coarse triangles, and where edges cross
  double border = 0;  // texels: from the vertices of fine outlines to the nearest point of the
                      // coarse outline, in space plus in uv
  double turn = 0;    // degrees: of fine triangles that lie over one coarse triangle
};

// Takes time in proportion to fine times coarse triangles.
ExactSlip exact_slip(const ChartedMesh& mesh, const SimplifiedMesh& coarse,
                     std::span<const double> texels_per_unit);
ExactSlip exact_slip(const ChartedMesh& mesh, const SimplifiedMesh& coarse, double density);

}  // namespace atlas::simplify_test
