// Independent checks of what a coarse mesh must preserve.
#pragma once

#include <span>

#include "libatlas/simplify/simplify.h"
#include "tests/simplify/shapes.h"

namespace atlas::simplify_test {

// Edges (pairs of positions) that belong to only one triangle, and their total length.
struct OpenEdges {
  std::size_t count = 0;
  double length = 0;
};
OpenEdges open_edges(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices);

// Returns the number of triangles without positive area in uv or in space, with uvs that do not
// belong to their positions, or with the wrong chart.
std::size_t broken_triangles(const ChartedMesh& mesh, const SimplifiedMesh& coarse);

// The slip in texels at points that are scattered over the fine triangles. It is found by searching
// the coarse triangle with the same uv. If there is none (at a straightened border), the nearest
// one is taken and the distance to it in uv is added. That sum is divided by the chart's largest
// stretch, because the bound is multiplied by it there.
struct SampledSlip {
  double inside = 0, outside = 0;  // the largest ones
  double outside_share = 0;        // share of the samples
  double turned_share = 0;  // share of the area whose normals differ by more than the given angle
};
SampledSlip sample_slip(const ChartedMesh& mesh, const SimplifiedMesh& coarse,
                        std::span<const double> texels_per_unit, double max_turn_degrees);

double uv_area(const ChartedMesh& mesh, const SimplifiedMesh& coarse);

}  // namespace atlas::simplify_test
