// What a coarse mesh must keep, checked by routes of its own.
#pragma once

#include <span>

#include "libatlas/simplify/simplify.h"
#include "tests/simplify/shapes.h"

namespace atlas::simplify_test {

// Edges (pairs of positions) that belong to one triangle only, and their total length.
struct OpenEdges {
  std::size_t count = 0;
  double length = 0;
};
OpenEdges open_edges(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices);

// Triangles without positive area in uv or in space, or whose uvs and positions do not belong
// together, or whose chart is wrong.
std::size_t broken_triangles(const ChartedMesh& mesh, const SimplifiedMesh& coarse);

// The slip at points strewn over the fine triangles, found by searching the coarse triangle with
// the same uv; where there is none (a straightened border), the one least off, and the distance to
// it in uv counts too, all divided by the chart's largest stretch, which the bound is multiplied by
// there. In texels.
struct SampledSlip {
  double inside = 0, outside = 0;  // largest
  double outside_share = 0;        // of the samples
  double turned_share = 0;         // of the area: normals there differ by more than the angle given
};
SampledSlip sample_slip(const ChartedMesh& mesh, const SimplifiedMesh& coarse,
                        std::span<const double> texels_per_unit, double max_turn_degrees);

double uv_area(const ChartedMesh& mesh, const SimplifiedMesh& coarse);

}  // namespace atlas::simplify_test
