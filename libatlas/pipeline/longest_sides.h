// Internal: how long a chart may be before it is cut for the sake of the others.
#pragma once

#include <span>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/pipeline/export_options.h"
#include "libatlas/texture/chart_textures.h"

namespace atlas {

struct PageBudget {
  const TextureOptions& texture;
  const ExportOptions& options;
};

// A chart longer than a page would lose density that its neighbours keep, and one nearly as long
// leaves a page half empty: in the test room halves let the common scale rise from 0.76 to 0.87.
// `densities`: texels per unit that each chart wants. Returns scene units, 1 a chart.
std::vector<double> longest_sides(const ChartSet& charts, std::span<const double> densities,
                                  const PageBudget& budget);

}  // namespace atlas
