// Internal: what is certain of the room that charts need, before their light has been sampled.
#pragma once

#include <span>

#include "libatlas/charts/charts.h"
#include "libatlas/core/status.h"
#include "libatlas/unwrap/layout_effort.h"
#include "libatlas/unwrap/page_layout.h"

namespace atlas {

// Returns the texels that the charts take on pages at least, with their gutters, however far
// textures are halved and however small packing makes them. `densities` are the texels per unit of
// full textures, one per chart, > 0; sides beyond the page's do not count.
double least_texels(const ChartSet& charts, std::span<const double> densities,
                    const LayoutOptions& options);

// Returns the texels that charts of these sizes take at least, with gutters of `padding` texels.
double texels_with_gutters(const WantedCharts& wanted, double padding);

// Returns a share of the pages that charts of one density do not exceed however they are laid out,
// because their gutters take the rest. With options.free_aspect, it is a share of the page as it is
// cropped. minimum_side is not taken into account.
double most_covered(const ChartSet& charts, double density, const LayoutOptions& options);

// Returns no_solution if least_texels() are more than the pages hold. Sampling textures of charts
// that cannot fit took most of the time of such an export.
Status check_least_room(const ChartSet& charts, std::span<const double> densities,
                        const LayoutOptions& options);

// Returns the error for charts that do not fit, in the words of these options.
Status no_room(const ChartSet& charts, const LayoutOptions& options);

}  // namespace atlas
