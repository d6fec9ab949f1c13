// Internal: finds charts that are copies of one another, such as those of chairs in a hall.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/pack/outlines/chart_outline.h"

namespace atlas::pack {

// Charts whose outer loops coincide after a turn and a shift. Mirror images do not.
struct AlikeCharts {
  std::vector<std::uint32_t> charts;  // in ascending order
  // By which each chart is turned about its origin, in radians, to lie as the first one does.
  std::vector<double> turns;
};

// Returns all groups of at least `fewest` charts, largest area in total first. Charts with loose
// triangles are in none. May be incomplete if the context is cancelled.
std::vector<AlikeCharts> find_alike(std::span<const ChartOutline> outlines, std::size_t fewest,
                                    const Context& context);

}  // namespace atlas::pack
