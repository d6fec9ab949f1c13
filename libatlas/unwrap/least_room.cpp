#include "libatlas/unwrap/least_room.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libatlas/core/counted.h"

namespace atlas {
namespace {

// Returns the texels of a chart with its gutter. The points within the padding's distance of a
// chart belong to no other one, neither by boxes nor by outlines. Around area A they take at least
// (√A + r √π)² (Brunn and Minkowski), and around a connected set of length L at least 2 r L + π r².
double with_gutter(double area, double length, double padding) {
  constexpr double kPi = std::numbers::pi;
  const double around = std::sqrt(area) + padding * std::sqrt(kPi);
  return std::max(around * around, 2 * padding * length + kPi * padding * padding);
}

}  // namespace

double least_texels(const ChartSet& charts, std::span<const double> densities,
                    const LayoutOptions& options) {
  // Textures are halved as long as the smaller one has minimum_side texels, rounded up, and the
  // common scale makes no chart shorter than that.
  const double floor_side = std::max(0.0, options.minimum_side - 1.0);
  double texels = 0;
  for (std::size_t c = 0; c < charts.charts.size(); ++c) {
    const Chart& chart = charts.charts[c];
    const double longest = std::max(chart.size.x, chart.size.y);
    if (!(longest > 0)) continue;
    const double side = std::min(longest * densities[c], floor_side);
    const double density = side / longest;
    texels += with_gutter(chart.distortion.uv_area * density * density, side, options.padding);
  }
  return texels;
}

double texels_with_gutters(const WantedCharts& wanted, double padding) {
  double texels = 0;
  for (std::size_t c = 0; c < wanted.charts.charts.size(); ++c) {
    const Chart& chart = wanted.charts.charts[c];
    const Vec2d density = wanted.texels_per_unit[c];
    const double longest = std::max(chart.size.x * density.x, chart.size.y * density.y);
    texels += with_gutter(chart.distortion.uv_area * density.x * density.y, longest, padding);
  }
  return texels;
}

double most_covered(const ChartSet& charts, double density, const LayoutOptions& options) {
  // Within the padding p of a connected chart of area A and length L lie at least A + 2 p L + 4 p²
  // texels: each row and column that it meets becomes longer by 2 p. At scale s these are
  // a s² + b s + c in all. The share of a s² in them grows with s.
  const double room = double(options.pages) * options.page_size * options.page_size;
  const double p = options.padding;
  double a = 0, b = 0, c = 0, longest = 0;
  for (const Chart& chart : charts.charts) {
    const double side = density * std::max(chart.size.x, chart.size.y);
    a += density * density * chart.distortion.uv_area;
    b += 2 * p * side;
    c += 4 * p * p;
    longest = std::max(longest, side);
  }
  if (!(a > 0) || c >= room) return 0;
  const double fits = 2 * (room - c) / (b + std::sqrt(b * b + 4 * a * (room - c)));
  const double alone = std::numbers::sqrt2 * options.page_size / longest;  // along the diagonal
  const double s = std::min({1.0, fits, alone});
  return a * s * s / (options.free_aspect ? a * s * s + b * s + c : room);
}

Status check_least_room(const ChartSet& charts, std::span<const double> densities,
                        const LayoutOptions& options) {
  const double room = double(options.pages) * options.page_size * options.page_size;
  const bool full = least_texels(charts, densities, options) > room;
  return full ? no_room(charts, options) : Status{};
}

Status no_room(const ChartSet& charts, const LayoutOptions& options) {
  return {ErrorCode::no_solution,
          fmt::format("{} charts do not fit {} of {} x {} even as small as allowed ({})",
                      charts.charts.size(), counted(options.pages, "page"), options.page_size,
                      options.page_size, options.remedy)};
}

}  // namespace atlas
