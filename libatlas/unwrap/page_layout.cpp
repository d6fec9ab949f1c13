#include "libatlas/unwrap/page_layout.h"

#include <cmath>
#include <string_view>
#include <utility>

#include "libatlas/charts/chart_set_check.h"
#include "libatlas/unwrap/layout_effort.h"

namespace atlas {

double filling_density(const ChartSet& charts, double texels) {
  double area = 0;
  for (const Chart& chart : charts.charts) area += chart.distortion.uv_area;
  return area > 0 ? std::sqrt(texels / area) : 1;
}

Result<PageLayout> lay_out_pages(const ChartSet& charts, std::span<const Vec2d> texels_per_unit,
                                 const LayoutOptions& options, const Context& context) {
  constexpr std::string_view kWho = "pages";
  if (Status s = check_chart_arrays(charts, charts.triangle_uv.size(), kWho); !s.ok()) return s;
  if (Status s = check_triangle_lists(charts, kWho); !s.ok()) return s;
  for (std::size_t c = 0; c < charts.charts.size(); ++c)
    if (Status s = check_chart(charts, c, kWho); !s.ok()) return s;
  Result<WorkedLayout> layout = lay_out_charts({charts, texels_per_unit}, {options}, context);
  if (!layout.ok()) return layout.status();
  return PageLayout(std::move(*layout));
}

}  // namespace atlas
