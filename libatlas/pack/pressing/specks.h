// Internal: tells the charts that shape a page from the specks that its gaps take in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/pack/fit.h"
#include "libatlas/pack/outlines/chart_outline.h"

namespace atlas::pack {

// This many items fill the gaps of a page in any order.
inline constexpr std::size_t kManyItems = 1000;

// Returns the charts that are pressed, in ascending order: all of them if they are few; else those
// that are no specks, if these are few. Specks are far shorter than the page, and together they
// take a small share of it, gutters included. Returns nothing if too many charts are no specks.
std::vector<std::uint32_t> charts_to_press(std::span<const ChartOutline> outlines,
                                           const FitOptions& options);

// Returns whether some charts are pressed, and the others are specks.
bool has_specks(std::span<const ChartOutline> outlines, const FitOptions& options);

}  // namespace atlas::pack
