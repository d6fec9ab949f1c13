// Internal: scales of their own for charts that are so long that they alone decide the page.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/unwrap/page_layout.h"

namespace atlas {

// Returns the scales of charts relative to the common one, one per chart: 1 for most, and below 1
// for the charts that are more than twice as long as the side of a page (one of `pages`) that all
// charts would nearly fill, such that they become as long as that. The longest come first, as long
// as the others have half of the area. Returns nothing if there are none.
std::vector<double> own_scales(const ChartSet& charts, std::uint32_t pages);

// Returns the texels per unit of length of all charts but those of PageLayout::own_scales.
double common_density(const PageLayout& layout);

// Returns a line that names the charts of PageLayout::own_scales, which must have some.
std::string own_scales_text(const ChartSet& charts, const PageLayout& layout);

}  // namespace atlas
