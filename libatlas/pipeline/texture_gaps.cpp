#include "libatlas/pipeline/texture_gaps.h"

#include <algorithm>
#include <vector>

namespace atlas {

GapReport open_texture_gaps(const PagesOfCharts& pages, const TexturesOfCharts& textures,
                            ChartSet& charts, const Context& context) {
  std::vector<Vec2d> densities;
  for (const ChartTexture& t : textures.charts)
    densities.push_back(t.content == ChartContent::varied ? t.texels_per_unit : Vec2d{});
  const GapReport report = open_part_gaps(pages, densities, charts, context);
  for (std::size_t c = 0; c < densities.size(); ++c) {
    ChartTexture& texture = textures.charts[c];
    const Vec2d d = texture.texels_per_unit, size = charts.charts[c].size;
    const double longest = std::max(size.x * d.x, size.y * d.y);
    if (!(densities[c].x > 0) || !(longest > textures.max_side)) continue;
    const double fit = textures.max_side / longest;
    texture.texels_per_unit = {fit * d.x, fit * d.y};
  }
  return report;
}

}  // namespace atlas
