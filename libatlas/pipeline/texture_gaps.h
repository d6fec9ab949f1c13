// Internal: opens gaps between the parts of charts that get textures.
#pragma once

#include <cstdint>
#include <span>

#include "libatlas/texture/chart_textures.h"
#include "libatlas/unwrap/part_gaps.h"

namespace atlas {

struct TexturesOfCharts {
  std::span<ChartTexture> charts;  // one per chart
  std::int32_t max_side;           // longest side of a chart, texels
};

// Does open_part_gaps() for charts with light. Charts of one colour are left alone, because they
// have no light to mix. A chart that becomes longer than max_side gets a lower density.
GapReport open_texture_gaps(const PagesOfCharts& pages, const TexturesOfCharts& textures,
                            ChartSet& charts, const Context& context);

}  // namespace atlas
