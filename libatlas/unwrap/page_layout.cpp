#include "libatlas/unwrap/page_layout.h"

#include <cmath>
#include <utility>

#include "libatlas/unwrap/layout_effort.h"

namespace atlas {

double filling_density(const ChartSet& charts, double texels) {
  double area = 0;
  for (const Chart& chart : charts.charts) area += chart.distortion.uv_area;
  return area > 0 ? std::sqrt(texels / area) : 1;
}

Result<PageLayout> lay_out_pages(const ChartSet& charts, std::span<const Vec2d> texels_per_unit,
                                 const LayoutOptions& options, const Context& context) {
  Result<WorkedLayout> layout = lay_out_charts({charts, texels_per_unit}, {options}, context);
  if (!layout.ok()) return layout.status();
  return PageLayout(std::move(*layout));
}

}  // namespace atlas
