// Internal: the ways of fitting charts to pages: by boxes, by outlines, by pressing outlines.
#pragma once

#include <optional>

#include "libatlas/pack/chart_outline.h"
#include "libatlas/pack/fit.h"

namespace atlas::pack {

// fit_pages for charts given by their sizes alone; the arguments have been checked.
Result<FitResult> fit_boxes(std::span<const FitItem> items, const FitOptions& options,
                            const Context& context);

// fit_pages for charts given by their outlines; the arguments have been checked. lost_area is left
// to the caller.
Result<FitResult> fit_outlines(std::span<const FitItem> items,
                               std::span<const ChartOutline> outlines, const FitOptions& options,
                               const Context& context);

// The same for one page of few charts, as full as pressing makes it. None where that is not worth
// trying (worth_pressing), found nothing, or is not what was asked for: where all fit at the
// largest scale and the page could be smaller, or where charts stop at their minimum sides.
std::optional<FitResult> fit_pressed(std::span<const FitItem> items,
                                     std::span<const ChartOutline> outlines,
                                     const FitOptions& options, const Context& context);

// A fit to several pages of few charts each made denser: every page is pressed, and charts change
// pages until no page is much tighter than the others. None where that is not worth trying or finds
// no larger scale than the fit's. Layouts are added to those of the fit in any case.
std::optional<FitResult> press_pages(FitResult& fitted, std::span<const FitItem> items,
                                     std::span<const ChartOutline> outlines,
                                     const FitOptions& options, const Context& context);

// F(A) = N over these areas, without a search below the bisection's answer: it is asked for at
// every scale tried. False where there is none (the areas pass 2^62, or cancelled).
bool group_areas(std::span<const std::uint64_t> areas, std::uint32_t pages, const Context& context,
                 GroupingResult& grouping);

// So many items fill the gaps of a page whatever their order.
inline constexpr std::size_t kManyItems = 1000;

// How close to the largest scale that fits a search should come, as a share: `exact`, or roughly
// where the page is cropped to what many items need.
double scale_tolerance(const FitOptions& options, double exact, std::size_t items);

// Page sizes with power-of-two sides smaller than the largest, ascending by area, texels.
std::vector<Extent> smaller_pages(const FitOptions& options);

}  // namespace atlas::pack
