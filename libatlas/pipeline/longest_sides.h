// Internal: how long charts may be for the pages, and how long texels become on these.
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

// Returns how long each chart may be, in scene units, one value per chart. A chart longer than a
// page would lose density that its neighbours keep, and one nearly as long would leave a page half
// empty. In the test room, charts of at most half a page let the common scale rise from 0.76 to
// 0.87. `densities` are the texels per unit that each chart wants.
std::vector<double> longest_sides(const ChartSet& charts, std::span<const double> densities,
                                  const PageBudget& budget);

// Returns the mean length of a texel on the pages before downsizing, in scene units, where charts
// with the given full densities are packed at a common scale; 0 without area. Densities above that
// of `texel`, the length asked for, count as that.
double packed_texel(const ChartSet& charts, std::span<const Vec2d> densities, double scale,
                    double texel);

}  // namespace atlas
