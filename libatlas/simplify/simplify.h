// Makes the coarser mesh. Once the light is in the texture, the fine triangles that carried it are
// no longer needed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"

namespace atlas {

struct SimplifyOptions {
  // How far the surface, and the texture on it, may slip, in texels of the chart. The slip at a
  // point of the fine surface is its distance to the coarse surface's point with the same texture
  // coordinates. Where a chart border is straightened, the slip is that distance plus the border's
  // own shift in uv. Greater than 0.
  double max_slip_texels = 0.5;
  // The same for open borders (edges of one triangle only). It is small, since another object may
  // end there without sharing a vertex, and a gap would be visible. A value above max_slip_texels
  // counts as max_slip_texels.
  double max_border_slip_texels = 0.02;
  // The largest angle between the normals of a coarse triangle and of any fine triangle that it
  // replaces, in degrees. It is below 90, so nothing flips. What of a fine triangle lies in the
  // coarse one does not count if its width, its area divided by its longest side, is less than a
  // tenth of max_slip_texels.
  double max_turn_degrees = 60;
};

// The result: triangles over the *input's* positions and uvs. Vertices are only removed and never
// moved, so both sides of a seam stay bitwise equal.
struct SimplifiedMesh {
  std::vector<std::uint32_t> indices = {};         // 3 a triangle, into MeshView::positions
  std::vector<std::uint32_t> uv_indices = {};      // 3 a triangle, into ChartSet::uvs
  std::vector<std::uint32_t> triangle_chart = {};  // 1 a triangle, ascending
  // 1 a triangle: an input triangle of the same chart, within it or beside it. It gives the
  // material.
  std::vector<std::uint32_t> source_triangle = {};
  std::uint64_t triangles_in = 0, triangles_out = 0;
  double max_slip_texels = 0;   // an upper bound of the slip anywhere, <= the option
  double max_turn_degrees = 0;  // an upper bound of the turn anywhere, <= the option
  // Triangles of the input without area in space or in uv. They are collapsed if the rules allow
  // it, and otherwise kept, because a hole might open. Triangles with two equal corners are
  // dropped.
  std::uint64_t degenerate_in = 0, degenerate_kept = 0, degenerate_dropped = 0;
};

// What is simplified. The data must exist until the call returns.
struct SimplifyInput {
  MeshView mesh = {};
  const ChartSet& charts;
  std::span<const double> texels_per_unit = {};  // 1 a chart: texels a unit of ChartSet::uvs, > 0
};

// Removes vertices by half-edge collapses (OpenMesh) within the bounds above. If the same charts
// share both border edges at a vertex, the vertex is removed from all of these charts at once, so
// that no crack opens. Border vertices where other charts, borders or non-manifold edges meet stay.
// Every coarse triangle has positive area in uv (exact test) and in space, except degenerate
// triangles of the input that were kept. Output triangles have their chart's orientation, also
// those in ChartSet::flipped_triangles. The result is the same for every thread count. Method:
// docs/simplify.md.
// Errors: bad_input if the spans do not fit together or texels_per_unit holds a number that is not
// positive; bad_option; cancelled.
Result<SimplifiedMesh> simplify_charts(const SimplifyInput& input, const SimplifyOptions& options,
                                       const Context& context);

}  // namespace atlas
