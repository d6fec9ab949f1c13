// Internal: how long charts may be for the pages, and how long texels become on these.
#pragma once

#include <span>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/pipeline/export_options.h"
#include "libatlas/texture/chart_textures.h"
#include "libatlas/unwrap/page_layout.h"

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

// Returns the factor at which textures are to be sized, at most 1. It is below 1 if a chart is
// longer than a page at the full densities: such a chart would be coarsened to fit its page, and
// once more with all others by the common scale. Sized by an upper estimate of that scale, charts
// within longest_sides() fit, and all keep one density.
double sizing_factor(const ChartSet& charts, std::span<const double> densities,
                     const PageBudget& budget);

// Returns the factor after textures were sized by `factor`: a larger one if light of one colour, or
// nearly, left them so small that they would not fill the pages, else the same.
double refilled_factor(double factor, const TextureResult& sized, const PageBudget& budget);

// Multiplies all densities that the options ask for.
TextureOptions scaled(TextureOptions options, double factor);

// Returns the mean length of a texel on the pages before downsizing, in scene units, where charts
// with the given full densities are packed at a common scale; 0 without area. Densities above that
// of `texel`, the length asked for, count as that.
double packed_texel(const ChartSet& charts, std::span<const Vec2d> densities, double scale,
                    double texel);

// Returns the share of the pages' texels that charts have only because no side may become shorter
// than LayoutOptions::minimum_side: what they hold beyond the common scale. `densities` are the
// wanted ones, as for lay_out_pages().
double least_side_share(const ChartSet& charts, std::span<const Vec2d> densities,
                        const PageLayout& layout);

}  // namespace atlas
