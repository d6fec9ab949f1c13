// Internal: where the uvs of charts lie on their pages.
#pragma once

#include <cmath>
#include <cstddef>
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
  // One per uv of the charts, or empty: where the uvs of charts that stay as they were lie, in
  // texels of their page; NaN for those of the other charts.
  std::span<const Vec2d> kept_texels = {};

  bool stays(std::size_t chart) const {
    return !kept_texels.empty() && !std::isnan(kept_texels[charts.charts[chart].first_uv].x);
  }
};

// Returns where each uv of the charts lies on its chart's page, as a fraction of the page's sides
// (origin bottom left). The values are not rounded yet, see round_uvs.h.
std::vector<Vec2d> page_uvs(const PlacedCharts& placed);

}  // namespace atlas
