#include "libatlas/pipeline/part_gaps.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace atlas {
namespace {

// Of the pages' texels, that charts will cover at least where the pages are full: with gutters,
// usually 0.6 to 0.7. A gap a little wider than needed costs less than one that is not.
constexpr double kLikelyFill = 0.6;

double clearance_at(Vec2d density) {
  const double least = std::min(density.x, density.y);
  return least > 0 ? kTexelsApart / least : 0;
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
  return widen_gaps(pages.mesh, clearance, pages.max_stretch, charts, context);
}

GapReport open_part_gaps(const PagesOfCharts& pages, std::span<ChartTexture> textures,
                         ChartSet& charts, const Context& context) {
  std::vector<Vec2d> densities;
  for (const ChartTexture& t : textures)
    densities.push_back(t.content == ChartContent::varied ? t.texels_per_unit : Vec2d{});
  const GapReport report = open_part_gaps(pages, densities, charts, context);
  for (std::size_t c = 0; c < textures.size(); ++c) {
    const Vec2d d = textures[c].texels_per_unit, size = charts.charts[c].size;
    const double longest = std::max(size.x * d.x, size.y * d.y);
    if (!(densities[c].x > 0) || !(longest > pages.max_side)) continue;
    const double fit = pages.max_side / longest;
    textures[c].texels_per_unit = {fit * d.x, fit * d.y};
  }
  return report;
}

GapReport left_part_gaps(const MeshView& mesh, const ChartSet& charts,
                         std::span<const ChartPlacement> placements, const Context& context) {
  std::vector<double> clearance(charts.charts.size(), 0);
  for (const ChartPlacement& p : placements) clearance[p.chart] = clearance_at(p.texels_per_unit);
  GapReport left = measure_gaps(mesh, clearance, charts, context);
  for (double* length : {&left.border, &left.near_before, &left.near_after})
    *length *= kTexelsApart;
  return left;
}

}  // namespace atlas
