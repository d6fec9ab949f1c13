// Internal: the problem of laying out pages in the terms of the packer, and its result in those of
// the pipeline.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/pack/fitting/fit_search.h"
#include "libatlas/unwrap/layout_effort.h"

namespace atlas {

// The outlines of charts, as the packer takes them: corners in texels at scale 1, and triangles
// whose corners are numbered within their chart.
struct ChartOutlines {
  std::vector<Vec2d> corners;
  std::vector<std::uint32_t> triangles;
  std::vector<ChartShape> shapes;

  ChartOutlines(const ChartSet& set, std::span<const Vec2d> density);
};

// Returns the packer's options for boxes: the number and size of pages, gutters, sides and turns.
FitOptions box_fit_options(const LayoutOptions& options);

// Returns a chart's box in texels at scale 1.
FitItem chart_box(const Chart& chart, Vec2d texels_per_unit);

// The problem for the packer, by boxes or by outlines as options.outlines says. What it is made
// from must outlive it.
struct LayoutProblem {
  const ChartSet& charts;
  std::span<const Vec2d> texels_per_unit;
  const LayoutEffort& options;
  std::vector<FitItem> items;
  std::optional<ChartOutlines> outlines;
  pack::FitSearchOptions fit;

  LayoutProblem(const WantedCharts& wanted, const LayoutEffort& how);
  LayoutProblem(const LayoutProblem&) = delete;  // `fit` refers to `outlines`
  LayoutProblem& operator=(const LayoutProblem&) = delete;
};

// A chart that lies by its outline: its box with `padding` texels around it, its angle in radians,
// and where its origin lies. Chart, page and density are left to the caller.
ChartPlacement outlined_placement(const Rect& box, double angle, Vec2d offset,
                                  std::int32_t padding);

// Returns the area of placed charts / area of the pages.
double uv_utilization(const ChartSet& charts, const PageLayout& layout);

// Converts the packer's result.
WorkedLayout layout_of(FitResult fitted, const LayoutProblem& problem);

}  // namespace atlas
