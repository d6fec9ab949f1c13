// Internal: the ways to fit charts to pages: by boxes, by outlines, and by pressing outlines.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "libatlas/pack/fitting/fit_search.h"
#include "libatlas/pack/nesting/pairs.h"
#include "libatlas/pack/nesting/rows.h"
#include "libatlas/pack/outlines/chart_outline.h"

namespace atlas::pack {

// Does fit_pages for charts given by their sizes alone. The arguments must have been checked.
Result<FitResult> fit_boxes(std::span<const FitItem> items, const FitOptions& options,
                            const Context& context);

// How charts may be joined, which is the same at each scale: the first search that asks finds it.
struct Joins {
  bool found = false;
  std::vector<ChartPair> pairs;
  std::vector<RowPlan> rows;
};

// Charts given by their outlines, which have an item each.
struct FitCharts {
  std::span<const FitItem> items = {};
  std::span<const ChartOutline> outlines = {};
  std::shared_ptr<Joins> joins = std::make_shared<Joins>();
};

// Does fit_pages for charts given by their outlines. The arguments must have been checked. The
// caller has to set lost_area.
Result<FitResult> fit_outlines(const FitCharts& charts, const FitSearchOptions& options,
                               const Context& context);

// Returns whether fit_pressed is worth a try.
bool may_be_pressed(std::span<const ChartOutline> outlines, const FitSearchOptions& options);

// Does the same for one page of few charts by pressing. Returns nothing if pressing is not worth a
// try, finds nothing, or does not give what was asked for: if all charts fit at
// the largest scale and the page could be smaller, or if some charts reach their minimum sides.
std::optional<FitResult> fit_pressed(const FitCharts& charts, const FitSearchOptions& options,
                                     const Context& context);

// Makes a fit to several pages of few charts each denser. Every page is pressed, and charts change
// pages until no page is much tighter than the others. Returns nothing if this is not worth a try
// or finds no larger scale than the fit has. The layouts tried are added to those of the fit in any
// case.
std::optional<FitResult> press_pages(FitResult& fitted, const FitCharts& charts,
                                     const FitSearchOptions& options, const Context& context);

// Groups these areas by F(A) = N. It does not search below the bisection's result, because it is
// called for every scale that is tried. Returns false if there is no grouping (the areas exceed
// 2^62, or the context is cancelled).
bool group_areas(std::span<const std::uint64_t> areas, std::uint32_t pages, const Context& context,
                 GroupingResult& grouping);

// Returns the grouping of areas that count cells of `cell` x `cell` texels, in texels.
GroupingResult in_texels(GroupingResult grouping, std::int32_t cell);

// Returns the page sizes with power-of-two sides that are smaller than the largest, in texels, in
// ascending order of area.
std::vector<Extent> smaller_pages(const FitOptions& options);

}  // namespace atlas::pack
