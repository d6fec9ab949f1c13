// Internal: room within charts' outlines that no packing could use.
#pragma once

#include <span>

#include "libatlas/pack/chart_outline.h"

namespace atlas::pack {

// Of all holes together, what no chart could lie in: those too small to matter once a chart were
// cut through them, less the charts that are smaller than the largest of these. Texels² at scale 1.
double lost_to_holes(std::span<const ChartOutline> outlines);

// The same of bays, which the outer borders leave open, as between the teeth of a comb or the
// windings of a spiral: those narrower than a small share of the side of all charts, or than two
// gutters on either side; less the charts that are narrower than such bays. `gutter`: around each
// chart, texels at scale 1.
double lost_to_bays(std::span<const ChartOutline> outlines, double gutter, const Context& context);

}  // namespace atlas::pack
