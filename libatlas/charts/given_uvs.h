// Internal: the charts of an input uv set, taken over as they are where they are usable.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/charts/mesh/topology.h"
#include "libatlas/core/context.h"

namespace atlas {

// 1 a corner: MeshView::texcoord_indices with kNoIndex where it is out of range or the texcoord is
// not finite; empty if the mesh has none. Corners without texcoord agree with each other, so that
// an unusable region stays in one piece.
std::vector<std::uint32_t> usable_texcoords(const MeshView& mesh);

struct GivenUvsResult {
  std::vector<FlatChart> charts;   // ordered by first triangle
  std::uint64_t kept_charts = 0;   // given charts whose uvs were taken,
  std::uint64_t reflattened = 0;   // and the others
  std::uint64_t split_charts = 0;  // of those others: cut into smaller ones
  ChartSet::Timing timing;         // of segmenting, and the parts of everything
};

// `input.topology` was cut at the uv seams of `mesh`, whose texcoord_indices are those of
// usable_texcoords: its components are the given charts. A given chart is kept if its uvs, exactly
// mirrored back where they are mirrored as a whole, are injective before and after they are scaled
// to the surface's area and turned for packing, no triangle is too thin to survive being written,
// and the cone is within the limit; a chart that is folded over, if all of its parts are (see
// uv_folds.h). The others are flattened anew inside their outlines; where one does not flatten in
// one piece, it is segmented as well, and what gives fewer charts is taken. Charts run in parallel;
// the result does not depend on how.
GivenUvsResult flatten_given_uvs(const FlattenInput& input, const MeshView& mesh,
                                 const Context& context);

}  // namespace atlas
