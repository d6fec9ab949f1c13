#include "libatlas/uvs/page_uvs.h"

namespace atlas {

std::vector<Vec2d> page_uvs(const PlacedCharts& placed) {
  const ChartSet& set = placed.charts;
  std::vector<Vec2d> uvs(set.uvs.size());
  for (const ChartPlacement& placement : placed.placements) {
    const Chart& chart = set.charts[placement.chart];
    const Extent page = placed.pages[std::size_t(placement.page)];
    for (std::uint32_t i = chart.first_uv; i < chart.first_uv + chart.uv_count; ++i) {
      const Vec2d texel =
          placed.stays(placement.chart) ? placed.kept_texels[i] : page_texel(placement, set.uvs[i]);
      uvs[i] = {texel.x / page.width, texel.y / page.height};
    }
  }
  return uvs;
}

}  // namespace atlas
