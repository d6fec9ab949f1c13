// Internal: keeps the charts of a given uv set where they are usable, and flattens the others.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/charts/mesh/topology.h"
#include "libatlas/core/context.h"

namespace atlas {

// Returns MeshView::texcoord_indices, one per corner, with kNoIndex where the index is out of range
// or the texcoord is not finite; empty if the mesh has none. Corners without texcoord agree with
// each other, so an unusable region stays connected.
std::vector<std::uint32_t> usable_texcoords(const MeshView& mesh);

struct GivenUvsResult {
  std::vector<FlatChart> charts = {};  // ordered by first triangle
  std::uint64_t kept_charts = 0;       // given charts whose uvs were kept
  std::uint64_t reflattened = 0;       // the other given charts
  std::uint64_t split_charts = 0;      // reflattened charts that were divided
  ChartSet::Timing timing = {};        // of segmentation, and the parts of everything
};

// Keeps or flattens the given charts, which are the components of `input.topology`: it must have
// been cut at the uv seams of `mesh`, whose texcoord_indices must be those of usable_texcoords(). A
// given chart is kept if its uvs (mirrored back exactly where they are mirrored as a whole) are
// injective, both before and after they are scaled to the surface's area and turned for packing, if
// no triangle is too thin to survive being written, if the cone is within the limit, and if its uvs
// are not many times as long as its border. A chart that is folded over is kept if all of its parts
// can be (see uv_folds.h). The others are flattened within their outlines; those that do not
// flatten in one piece are segmented as well, and the way that gives fewer charts is taken. Charts
// run in parallel; the result does not depend on the number of threads.
GivenUvsResult flatten_given_uvs(const FlattenInput& input, const MeshView& mesh,
                                 const Context& context);

}  // namespace atlas
