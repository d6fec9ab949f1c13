#include "libatlas/pipeline/longest_sides.h"

#include <algorithm>
#include <cmath>

#include "libatlas/bake/placement.h"

namespace atlas {
namespace {

constexpr double kLongestShare = 0.5;  // of a page, that a chart may take along a side

double texels_of_pages(const ExportOptions& options) {
  return double(options.atlases) * options.atlas_size * options.atlas_size;
}

// Of the common scale, from above: what the charts want before downsizing against what the pages
// hold. A scene of kilometres would else be cut into thousands of pieces of a few texels.
double likely_scale(const ChartSet& charts, std::span<const double> densities,
                    const ExportOptions& options) {
  const double left = options.threshold > 0 ? 0.25 : 1;  // of the texels, after downsizing
  double wanted = 0;
  for (std::size_t c = 0; c < densities.size(); ++c) {
    wanted += charts.charts[c].distortion.uv_area * densities[c] * densities[c];
  }
  return wanted > 0 ? std::min(1.0, std::sqrt(texels_of_pages(options) / (left * wanted))) : 1;
}

// Pieces are no use where so many, each with its gutter, do not fit however small they become:
// limits are doubled until the smallest boxes take less than half of the pages.
void spare_small_pages(const ChartSet& charts, const ExportOptions& options,
                       std::vector<double>& limits) {
  const auto pieces_of = [&](std::size_t c) {
    const Vec2d size = charts.charts[c].size;
    return std::max(1.0, std::ceil(size.x / limits[c]) * std::ceil(size.y / limits[c]));
  };
  const int cell = 1 << options.mip_levels;
  const double side =
      cell * std::ceil((options.min_side + 2.0 * gutter_pad(options.mip_levels)) / cell);
  constexpr int kMostDoublings = 60;  // also ends where a limit is none
  for (int doublings = 0; doublings < kMostDoublings; ++doublings) {
    double pieces = 0;
    for (std::size_t c = 0; c < limits.size(); ++c) pieces += pieces_of(c);
    if (pieces <= double(limits.size()) || pieces * side * side <= texels_of_pages(options) / 2)
      return;
    for (double& limit : limits) limit *= 2;
  }
}

}  // namespace

std::vector<double> longest_sides(const ChartSet& charts, std::span<const double> densities,
                                  const PageBudget& budget) {
  const double shrinking = likely_scale(charts, densities, budget.options);
  std::vector<double> limits;
  for (const double density : densities)
    limits.push_back(kLongestShare * budget.texture.max_side / (density * shrinking));
  spare_small_pages(charts, budget.options, limits);
  return limits;
}

}  // namespace atlas
