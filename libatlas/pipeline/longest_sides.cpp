#include "libatlas/pipeline/longest_sides.h"

#include <algorithm>
#include <cmath>

#include "libatlas/uvs/placement.h"

namespace atlas {
namespace {

constexpr double kLongestShare = 0.5;  // share of a page's side that a chart may take

double texels_of_pages(const ExportOptions& options) {
  return double(options.atlases) * options.atlas_size * options.atlas_size;
}

// Returns an upper estimate of the common scale, from the texels that the charts want and those
// that the pages hold. Otherwise a scene of kilometres would be cut into thousands of pieces of a
// few texels.
double likely_scale(const ChartSet& charts, std::span<const double> densities,
                    const ExportOptions& options) {
  const double left = options.threshold > 0 ? 0.25 : 1;  // share of texels left by downsizing
  double wanted = 0;
  for (std::size_t c = 0; c < densities.size(); ++c) {
    wanted += charts.charts[c].distortion.uv_area * densities[c] * densities[c];
  }
  return wanted > 0 ? std::min(1.0, std::sqrt(texels_of_pages(options) / (left * wanted))) : 1;
}

// Doubles the limits until the smallest boxes take at most half of the pages. Cutting is of no use
// if there are so many pieces, each with its gutter, that they do not fit however small they
// become.
void spare_small_pages(const ChartSet& charts, const ExportOptions& options,
                       std::vector<double>& limits) {
  const auto pieces_of = [&](std::size_t c) {
    const Vec2d size = charts.charts[c].size;
    return std::max(1.0, std::ceil(size.x / limits[c]) * std::ceil(size.y / limits[c]));
  };
  const int cell = 1 << options.mip_levels;
  const double side =
      cell * std::ceil((options.min_side + 2.0 * gutter_pad(options.mip_levels)) / cell);
  constexpr int kMostDoublings = 60;  // also ends the loop if a limit is 0
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

double sizing_factor(const ChartSet& charts, std::span<const double> densities,
                     const PageBudget& budget) {
  bool fit = true;
  for (std::size_t c = 0; c < densities.size(); ++c) {
    const Vec2d size = charts.charts[c].size;
    fit = fit && std::max(size.x, size.y) * densities[c] <= budget.texture.max_side;
  }
  return fit ? 1 : likely_scale(charts, densities, budget.options);
}

double refilled_factor(double factor, const TextureResult& sized, const PageBudget& budget) {
  constexpr double kHardlyFilled = 0.5, kExpectedFill = 0.7;  // shares of the pages
  const double gutters = 2.0 * gutter_pad(budget.options.mip_levels);
  double texels = 0;
  for (const ChartTexture& t : sized.charts) texels += (t.width + gutters) * (t.height + gutters);
  const double room = texels_of_pages(budget.options);
  if (factor >= 1 || texels > kHardlyFilled * room) return factor;
  return std::min(1.0, factor * std::sqrt(kExpectedFill * room / texels));
}

TextureOptions scaled(TextureOptions options, double factor) {
  options.texel /= factor;
  options.texture_sampling *= factor;
  return options;
}

double packed_texel(const ChartSet& charts, std::span<const Vec2d> densities, double scale,
                    double texel) {
  double area = 0, texels = 0;
  for (std::size_t c = 0; c < charts.charts.size(); ++c) {
    const double surface = charts.charts[c].distortion.surface_area;
    const double density = std::min(densities[c].x, 1 / texel) * scale;
    area += surface;
    texels += surface * density * density;
  }
  return texels > 0 ? std::sqrt(area / texels) : 0;
}

double least_side_share(const ChartSet& charts, std::span<const Vec2d> densities,
                        const PageLayout& layout) {
  double held = 0, texels = 0;
  for (const ChartPlacement& placed : layout.placements) {
    const Chart& chart = charts.charts[placed.chart];
    const Vec2d wanted = densities[placed.chart], has = placed.texels_per_unit;
    const double scaled = wanted.x * wanted.y * layout.scale * layout.scale;
    const double area =
        layout.outlines ? chart.distortion.surface_area : chart.size.x * chart.size.y;
    held += area * std::max(0.0, has.x * has.y - scaled);
  }
  for (const Extent& page : layout.pages) texels += double(page.width) * page.height;
  return texels > 0 ? held / texels : 0;
}

}  // namespace atlas
