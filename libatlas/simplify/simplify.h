// The coarser mesh: once the light is in the texture, the fine triangles are no longer needed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"

namespace atlas {

struct SimplifyOptions {
  // How far the surface, and the texture on it, may slip: for a point of the fine surface with
  // texture coordinates uv, the distance to the coarse surface's point at the same uv, in texels of
  // its chart; where a chart border is straightened, that distance plus the border's own shift in
  // uv. Greater than 0.
  double max_slip_texels = 0.5;
  // The same for open borders (edges of one triangle only): small, since another object may end
  // there without sharing a vertex, and a gap would show.
  double max_border_slip_texels = 0.02;
  // Largest angle between a coarse triangle's normal and that of any fine triangle it stands for,
  // degrees, below 90: nothing flips. Strips narrower than a tenth of max_slip_texels do not count.
  double max_turn_degrees = 60;
};

// Triangles over the *input's* positions and uvs: vertices are only removed, never moved, so that
// both sides of a seam stay bitwise equal.
struct SimplifiedMesh {
  std::vector<std::uint32_t> indices;          // 3 a triangle, into MeshView::positions
  std::vector<std::uint32_t> uv_indices;       // 3 a triangle, into ChartSet::uvs
  std::vector<std::uint32_t> triangle_chart;   // 1 a triangle, ascending
  std::vector<std::uint32_t> source_triangle;  // 1 a triangle: a triangle of the input within it or
                                               // beside it, of the same chart (for its material)
  std::uint64_t triangles_in = 0, triangles_out = 0;
  double max_slip_texels = 0;   // an upper bound of the slip anywhere, <= the option
  double max_turn_degrees = 0;  // an upper bound of the turn anywhere, <= the option
  // Triangles of the input with no area in space or in uv: collapsed where the rules allow,
  // otherwise kept (a hole might open), those with two equal corners dropped.
  std::uint64_t degenerate_in = 0, degenerate_kept = 0, degenerate_dropped = 0;
  double cpu_seconds = 0;  // all threads
};

// What is simplified; it must outlive the call only.
struct SimplifyInput {
  MeshView mesh;
  const ChartSet& charts;
  std::span<const double> texels_per_unit;  // 1 a chart: texels a unit of ChartSet::uvs, > 0
};

// Removes vertices by half-edge collapses (OpenMesh) within the bounds above. Chart borders: a
// vertex between two border edges that the same charts share is removed from all of these charts
// at once, so no crack opens; border vertices where other charts, borders or non-manifold edges
// meet stay. Every coarse triangle has positive area in uv (exact test) and in space. Output
// triangles have their chart's orientation, also those in ChartSet::flipped_triangles.
// The result is the same for every thread count. Method: docs/simplify.md.
// Errors: bad_input when the spans do not fit together or texels_per_unit holds a number that is
// not positive; bad_option; cancelled.
Result<SimplifiedMesh> simplify_charts(const SimplifyInput& input, const SimplifyOptions& options,
                                       const Context& context);

}  // namespace atlas
