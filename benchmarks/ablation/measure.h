// What unwrapping makes of one mesh, in the figures of the ablation table.
#pragma once

#include <cstdint>

#include "benchmarks/ablation/seam_quality.h"
#include "libatlas/core/status.h"
#include "tests/support/shapes.h"

namespace atlas::bench {

struct UnwrapFigures {
  std::size_t charts = 0;
  double stretch_l2 = 1, stretch_999 = 1;
  SeamQuality seams;
  double page_use = 0;                         // area of the charts / area of the page
  double chart_seconds = 0, page_seconds = 0;  // CPU time of charts, and of packing and finishing
  // Triangles turned over or without area on the page, and texels that two triangles cover or
  // lookups of two charts read.
  std::uint64_t defects = 0;
};

// Moves the vertices of draws after the first by 0.1 % of a mean edge, since charts are a chaotic
// function of their input, and unwraps the mesh with default options on one thread. CPU time is
// that of the calling thread. Errors: those of unwrap_mesh().
Result<UnwrapFigures> measure_unwrap(const test::Shape& shape, std::uint32_t draw);

}  // namespace atlas::bench
