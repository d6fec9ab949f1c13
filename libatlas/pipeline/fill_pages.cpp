#include "libatlas/pipeline/fill_pages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "libatlas/charts/tiles.h"

namespace atlas {
namespace {

// Of the pages, what is full enough.
constexpr double kFilled = 0.7;
// Of the side of a page that all charts would fill without gaps: how long charts may be, in turn.
constexpr std::array kLongestSides{1.1, 0.9, 0.75, 0.6, 0.45};
// By how much more charts must cover for pieces to be worth it, at least, and for each square root
// of the surface's area that seams become longer by.
constexpr double kLeastGain = 0.1, kSeamPrice = 0.1;

Result<PageLayout> lay_out(const ChartSet& charts, double density, const LayoutOptions& options,
                           const Context& context) {
  const std::vector<Vec2d> densities(charts.charts.size(), Vec2d{density, density});
  return lay_out_pages(charts, densities, options, context);
}

double uv_area(const ChartSet& charts) {
  double area = 0;
  for (const Chart& chart : charts.charts) area += chart.distortion.uv_area;
  return area;
}

}  // namespace

Result<PageLayout> fill_pages(const PlainUvs& uvs, const LayoutOptions& options, ChartSet& charts,
                              const Context& context) {
  Result<PageLayout> best = lay_out(charts, uvs.density, options, context);
  if (options.free_aspect || uvs.options.keep_uv_charts || uvs.options.min_fill <= 0) return best;
  const double area = uv_area(charts), root_area = std::sqrt(charts.surface_area);
  const auto filled = [&] {  // of all pages there may be
    const double texels = double(options.pages) * options.page_size * options.page_size;
    const double density = uvs.density * best->scale;
    return best->scale >= 1 || area * density * density >= kFilled * texels;
  };
  if (!best.ok() || filled()) return best;
  const ChartSet whole = charts;
  const double side = std::sqrt(area / double(options.pages));
  for (const double longest : kLongestSides) {
    const std::vector<double> limits(whole.charts.size(), longest * side);
    ChartSet cut = whole;
    if (cut_to_limits(uvs.mesh, limits, uvs.options.max_stretch, cut) == 0) continue;
    Result<PageLayout> layout = lay_out(cut, uvs.density, options, context);
    if (!layout.ok()) return layout;
    const double gain = std::pow(layout->scale / best->scale, 2) - 1;
    const double seams = (cut.seam_length - charts.seam_length) / root_area;
    if (!(gain >= std::max(kLeastGain, kSeamPrice * seams))) continue;
    best = std::move(layout);
    charts = std::move(cut);
    if (filled()) break;
  }
  return best;
}

}  // namespace atlas
