#include "libatlas/pipeline/page_layout.h"

#include <algorithm>
#include <cmath>

namespace atlas {
namespace {

// What is left of a side after the common scale: sides stop at the smallest one allowed.
double scaled_density(double density, double side, double scale, double minimum_side) {
  const double floor_side = std::min(minimum_side, side);
  return side > 0 ? density * std::max(scale, floor_side / side) : density * scale;
}

double chart_texel_area(const ChartSet& charts, const std::vector<ChartPlacement>& placements) {
  double area = 0;
  for (const ChartPlacement& p : placements) {
    area += charts.charts[p.chart].distortion.uv_area * p.texels_per_unit.x * p.texels_per_unit.y;
  }
  return area;
}

}  // namespace

Result<PageLayout> lay_out_pages(const ChartSet& charts, std::span<const Vec2d> texels_per_unit,
                                 const LayoutOptions& options, const Context& context) {
  std::vector<FitItem> items(charts.charts.size());
  for (std::size_t c = 0; c < items.size(); ++c) {
    items[c] = {charts.charts[c].size.x * texels_per_unit[c].x,
                charts.charts[c].size.y * texels_per_unit[c].y};
  }
  FitOptions fit;
  fit.pages = options.pages;
  fit.page_size = options.page_size;
  fit.padding = options.padding;
  fit.alignment = options.alignment;
  fit.minimum_side = options.minimum_side;
  fit.preset = options.preset;
  Result<FitResult> fitted = fit_pages(items, fit, context);
  if (!fitted.ok()) return fitted.status();

  PageLayout layout;
  layout.scale = fitted->scale;
  layout.pages = fitted->pages;
  layout.utilization = fitted->utilization;
  layout.grouping = std::move(fitted->grouping);
  layout.placements.resize(items.size());
  for (std::size_t c = 0; c < items.size(); ++c) {
    const FitPlacement& from = fitted->placements[c];
    ChartPlacement& to = layout.placements[c];
    to.chart = std::uint32_t(c);
    to.page = std::int32_t(from.page);
    to.rotated = from.rotated;
    to.x = from.box.x + options.padding;
    to.y = from.box.y + options.padding;
    to.width = from.rotated ? from.content_height : from.content_width;
    to.height = from.rotated ? from.content_width : from.content_height;
    to.texels_per_unit = {scaled_density(texels_per_unit[c].x, items[c].width, layout.scale,
                                         options.minimum_side),
                          scaled_density(texels_per_unit[c].y, items[c].height, layout.scale,
                                         options.minimum_side)};
  }
  double page_area = 0;
  for (const Extent& page : layout.pages) page_area += double(page.area());
  layout.uv_utilization =
      page_area > 0 ? chart_texel_area(charts, layout.placements) / page_area : 0;
  return layout;
}

}  // namespace atlas
