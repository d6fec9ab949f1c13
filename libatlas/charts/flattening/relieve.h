// Internal: charts that stretch more than a short cut is worth are cut open.
#pragma once

#include <vector>

#include "libatlas/charts/flattening/flatten.h"

namespace atlas {

// Where large flat triangles meet a sharp or rounded corner inside a chart, the coarse mesh, whose
// fans bend where they cannot, knew a quarter of the stretch: 413 such charts had 37 % of the
// (L2 - 1) of 198 CAD parts. Charts of few triangles with much stretch are flattened anew with a
// dart from the border to a tip in the most stretched places, up to three one after another; it
// stays where the stretch that it saves is worth more than its seam is when cells are merged, and
// the chart sprawls no more. Not with ChartPreset::fast, a limit on cones or scan noise. Charts run
// in parallel; the result does not depend on how.
void relieve_charts(const FlattenInput& input, Partition& partition, std::vector<FlatChart>& charts,
                    const Context& context);

}  // namespace atlas
