#include "libatlas/unwrap/own_scales.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libatlas/core/counted.h"

namespace atlas {
namespace {

// How long charts may be, relative to the side of a square page that all would fill without gaps:
// pages that are 0.8 full have sides of 1.12.
constexpr double kLongest = 1.1;
// Charts that are longer than that by less than this factor keep the common scale.
constexpr double kFarLonger = 2;
// Charts at the common scale must have this share of the area. If they are the smaller part, long
// charts are what the page is for.
constexpr double kOthers = 0.5;

}  // namespace

std::vector<double> own_scales(const ChartSet& set, std::uint32_t pages) {
  const std::vector<Chart>& charts = set.charts;
  std::vector<std::uint32_t> order(charts.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return charts[a].size.x > charts[b].size.x;
  });
  double others = 0;
  for (const Chart& chart : charts) others += chart.distortion.uv_area;
  if (!(others > 0)) return {};
  const double enough = kOthers * others;
  // The longest charts, as they are tried one after another, are `longest` long. They then have
  // longest² times `slim` of the area, and the side of a page follows from that.
  double longest = kLongest * std::sqrt(others / pages), slim = 0;
  std::vector<double> scales(charts.size(), 1);
  std::size_t count = 0;
  for (; count < order.size() && charts[order[count]].size.x > kFarLonger * longest; ++count) {
    const Chart& chart = charts[order[count]];
    others -= chart.distortion.uv_area;
    slim += chart.distortion.uv_area / (chart.size.x * chart.size.x);
    const double room = pages - kLongest * kLongest * slim;
    if (others < enough || !(room > 0)) break;
    longest = kLongest * std::sqrt(others / room);
  }
  if (count == 0) return {};
  for (std::size_t k = 0; k < count; ++k) scales[order[k]] = longest / charts[order[k]].size.x;
  return scales;
}

double common_density(const PageLayout& layout) {
  double common = 0;
  for (const ChartPlacement& p : layout.placements) common = std::max(common, p.texels_per_unit.x);
  return common;
}

std::string own_scales_text(const ChartSet& charts, const PageLayout& layout) {
  constexpr std::size_t kNamed = 3;
  const double common = common_density(layout);
  std::string names;
  for (std::size_t k = 0; k < std::min(kNamed, layout.own_scales.size()); ++k) {
    const std::uint32_t c = layout.own_scales[k];
    names += fmt::format("{}charts[{}] of {} {:.2g} times as many", k > 0 ? ", " : "", c,
                         counted(charts.charts[c].triangle_count, "triangle"),
                         layout.placements[c].texels_per_unit.x / common);
  }
  if (layout.own_scales.size() > kNamed) names += ", ...";
  return fmt::format(
      "{} longer than the page that the others fill, and so coarser than these: {} texels per "
      "unit of length (shorter triangles would let them be cut instead)",
      layout.own_scales.size() == 1 ? std::string("1 chart is")
                                    : fmt::format("{} charts are", layout.own_scales.size()),
      names);
}

}  // namespace atlas
