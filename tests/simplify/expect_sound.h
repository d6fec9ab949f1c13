// Checks in one call what every coarse mesh must preserve.
#pragma once

#include "tests/simplify/checks.h"

namespace atlas::simplify_test {

// Simplifies with the same density for all charts. A failure is a test failure.
SimplifiedMesh simplify(const ChartedMesh& mesh, double density,
                        const SimplifyOptions& options = {}, const Context& context = {});

// Checks orientation, areas, indices, open edges, slip and turn, for meshes without degenerate
// triangles.
void expect_sound(const ChartedMesh& mesh, const SimplifiedMesh& coarse,
                  std::span<const double> densities, const SimplifyOptions& options = {});
void expect_sound(const ChartedMesh& mesh, const SimplifiedMesh& coarse, double density,
                  const SimplifyOptions& options = {});

}  // namespace atlas::simplify_test
