// Internal: cuts darts into charts whose stretch costs more than a short cut.
#pragma once

#include <vector>

#include "libatlas/charts/flattening/flatten.h"

namespace atlas {

// Where large flat triangles meet a sharp or rounded corner inside a chart, the coarse mesh
// underestimates the stretch, since its fans bend where those triangles cannot: merging knew of a
// quarter of it, and 413 such charts had 37 % of the L2 - 1 of 198 CAD parts. Charts of few
// triangles with much stretch are therefore flattened again with a dart from the border to a tip in
// the most stretched places, up to three one after another. A dart is kept if the stretch that it
// saves is worth more than its seam is when cells are merged, and the chart's rectangle grows
// little. Does nothing with ChartPreset::fast, a cone limit or scan noise. Charts run in parallel;
// the result does not depend on the number of threads.
void relieve_charts(const FlattenInput& input, Partition& partition, std::vector<FlatChart>& charts,
                    const Context& context);

}  // namespace atlas
