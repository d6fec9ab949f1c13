// Internal: scales of their own for charts that are so long that they alone decide the page.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/unwrap/page_layout.h"

namespace atlas {

// Returns the scales of charts relative to the common one, one per chart: below 1 for charts that
// are longer than the side of a page (one of `pages`) that all charts would nearly fill, such that
// they become as long as that, and 1 for the others. Returns nothing if no chart is so long, or if
// the others have less than half of the area.
std::vector<double> own_scales(const ChartSet& charts, std::uint32_t pages);

// Returns the texels per unit of length of all charts but those of PageLayout::own_scales.
double common_density(const PageLayout& layout);

// Returns a line that names the charts of PageLayout::own_scales, which must have some.
std::string own_scales_text(const ChartSet& charts, const PageLayout& layout);

}  // namespace atlas
