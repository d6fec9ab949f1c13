// Internal: where the uvs of charts lie on their pages.
#pragma once

#include <span>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/core/vec.h"
#include "libatlas/pack/pack.h"
#include "libatlas/uvs/placement.h"

namespace atlas {

// Together these say where a chart's uv lies on its page. Every placement names a chart of the set
// and one of the pages.
struct PlacedCharts {
  const ChartSet& charts;
  std::span<const ChartPlacement> placements;  // one per chart
  std::span<const Extent> pages;
};

// Returns where each uv of the charts lies on its chart's page, as a fraction of the page's sides
// (origin bottom left). The values are not rounded yet, see round_uvs.h.
std::vector<Vec2d> page_uvs(const PlacedCharts& placed);

}  // namespace atlas
