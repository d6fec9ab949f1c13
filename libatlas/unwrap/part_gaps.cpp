#include "libatlas/unwrap/part_gaps.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>
#include <vector>

#include "libatlas/core/clock.h"
#include "libatlas/core/progress.h"

namespace atlas {
namespace {

// The share of the pages' texels that charts will cover at least if the pages are full. With
// gutters, it is usually 0.6 to 0.7. The lower figure is used because a gap that is a little wider
// than needed costs less than one that is too narrow.
constexpr double kLikelyFill = 0.6;

// The factor by which charts may still become smaller once their gaps have been opened.
constexpr double kSmaller = 1.03;

// The share of progress and time for the first layout.
constexpr double kFirstLayout = 0.5;

double clearance_at(Vec2d density) {
  const double least = std::min(density.x, density.y);
  return least > 0 ? kTexelsApart / least : 0;
}

std::vector<double> clearances(std::span<const ChartPlacement> placements) {
  std::vector<double> clearance(placements.size(), 0);
  for (const ChartPlacement& p : placements) clearance[p.chart] = clearance_at(p.texels_per_unit);
  return clearance;
}

// The charts of a stage are those of its mesh, so nothing but cancelling can fail here. The stage
// notices that by itself.
GapReport report_of(const Result<GapReport>& report) {
  assert(report.ok() || report.status().code() == ErrorCode::cancelled);
  return report.ok() ? *report : GapReport{};
}

// Does fill_pages_apart(), except that progress may end before 1.
Result<PagesOfParts> filled_apart(const PlainUvs& uvs, const LayoutOptions& options,
                                  ChartSet& charts, const Context& context) {
  const double max_stretch = uvs.options.max_stretch;
  const double texels = double(options.pages) * options.page_size * options.page_size;
  const std::vector<Vec2d> wanted(charts.charts.size(), {uvs.density, uvs.density});
  PagesOfParts pages;
  pages.opened = open_part_gaps({uvs.mesh, max_stretch, texels}, wanted, charts, context).charts;
  const double begun = wall_seconds();
  LayoutOptions part = options;
  part.time_budget = kFirstLayout * options.time_budget;
  Result<PageLayout> layout =
      fill_pages(uvs, part, charts, part_of_stage(context, "packing", 0, kFirstLayout));
  if (!layout.ok()) return layout.status();
  pages.layout = std::move(*layout);
  pages.left = left_part_gaps(uvs.mesh, charts, pages.layout.placements, context);
  if (pages.left.near_after == 0) return pages;

  ChartSet wider = charts;
  std::vector<double> clearance = clearances(pages.layout.placements);
  for (double& c : clearance) c *= kSmaller;
  const Result<GapReport> opened = widen_gaps(uvs.mesh, {clearance, max_stretch}, wider, context);
  if (!opened.ok()) return opened.status();
  if (opened->charts == 0) return pages;
  part.time_budget = std::max(0.0, options.time_budget - (wall_seconds() - begun));
  layout = fill_pages(uvs, part, wider, part_of_stage(context, "packing", kFirstLayout, 1));
  if (context.cancelled()) return Status::cancelled();
  if (!layout.ok()) return pages;
  const GapReport left = left_part_gaps(uvs.mesh, wider, layout->placements, context);
  if (!(left.near_after < pages.left.near_after)) return pages;
  pages.opened = std::max(pages.opened, opened->charts);
  pages.layout = std::move(*layout);
  pages.left = left;
  charts = std::move(wider);
  return pages;
}

}  // namespace

GapReport open_part_gaps(const PagesOfCharts& pages, std::span<const Vec2d> densities,
                         ChartSet& charts, const Context& context) {
  double wanted = 0;
  for (std::size_t c = 0; c < densities.size(); ++c)
    wanted += charts.charts[c].distortion.uv_area * densities[c].x * densities[c].y;
  const double left = kLikelyFill * pages.texels;
  const double scale = wanted > left ? std::sqrt(left / wanted) : 1;
  std::vector<double> clearance;
  for (const Vec2d d : densities) clearance.push_back(clearance_at(d) / scale);
  return report_of(widen_gaps(pages.mesh, {clearance, pages.max_stretch}, charts, context));
}

GapReport left_part_gaps(const MeshView& mesh, const ChartSet& charts,
                         std::span<const ChartPlacement> placements, const Context& context) {
  GapReport left = report_of(measure_gaps(mesh, clearances(placements), charts, context));
  for (double* length : {&left.border, &left.near_before, &left.near_after})
    *length *= kTexelsApart;
  return left;
}

Result<PagesOfParts> fill_pages_apart(const PlainUvs& uvs, const LayoutOptions& options,
                                      ChartSet& charts, const Context& context) {
  Result<PagesOfParts> pages = filled_apart(uvs, options, charts, context);
  context.report("packing", 1);
  return pages;
}

}  // namespace atlas
