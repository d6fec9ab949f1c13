#include "libatlas/charts/filling/long_charts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <utility>

#include "libatlas/charts/flattening/part_of_chart.h"

namespace atlas {
namespace {

constexpr double kLeastFill = 0.75;  // of the least page
constexpr double kStrip = 4;         // times as long as wide, and each piece still longer than wide
constexpr std::size_t kMostStrips = 64;

double longer(const FlatChart& chart) {
  return std::max(chart.size.x, chart.size.y);
}
double shorter(const FlatChart& chart) {
  return std::min(chart.size.x, chart.size.y);
}

// Into how many lengths the chart must be cut for the page to be filled.
std::size_t pieces_wanted(const std::vector<FlatChart>& charts, std::size_t longest, double area) {
  double wide = 0;
  for (std::size_t k = 0; k < charts.size(); ++k) {
    if (k != longest) wide = std::max(wide, shorter(charts[k]));
  }
  const double page = longer(charts[longest]) * wide;
  return static_cast<std::size_t>(std::ceil(kLeastFill * page / area));
}

// The triangles of each of `count` equal lengths; none if one of them would come apart.
std::vector<std::vector<std::uint32_t>> lengths_of(const FlatChart& chart, std::size_t count) {
  const bool along_u = chart.size.x >= chart.size.y;
  std::vector<std::vector<std::uint32_t>> lengths(count);
  for (std::uint32_t i = 0; i < chart.corners.size(); ++i) {
    double middle = 0;
    for (const std::uint32_t v : chart.corners[i]) {
      middle += (along_u ? chart.uvs[v].x : chart.uvs[v].y) / 3;
    }
    const double place = double(count) * middle / longer(chart);
    lengths[std::min(count - 1, static_cast<std::size_t>(std::max(0.0, place)))].push_back(i);
  }
  for (const std::vector<std::uint32_t>& triangles : lengths) {
    if (connected_parts(chart, triangles).size() != 1) return {};
  }
  return lengths;
}

std::vector<FlatChart> cut(const FlattenInput& input, const FlatChart& chart, std::size_t count) {
  std::vector<FlatChart> pieces;
  for (const std::vector<std::uint32_t>& triangles : lengths_of(chart, count)) {
    pieces.push_back(part_of_chart(input, chart, triangles));
    const Distortion& d = pieces.back().distortion;
    if (d.stretch_999 > input.options.max_stretch || d.flips > 0) return {};
  }
  return pieces;
}

}  // namespace

std::size_t cut_long_charts(const FlattenInput& input, std::vector<FlatChart>& charts) {
  if (input.options.min_fill <= 0) return 0;
  double area = 0;
  for (const FlatChart& chart : charts) area += chart.distortion.uv_area;
  for (std::size_t count = 0; count < kMostStrips && charts.size() > 1; ++count) {
    const auto longest = std::max_element(
        charts.begin(), charts.end(),
        [](const FlatChart& a, const FlatChart& b) { return longer(a) < longer(b); });
    const double slim = longer(*longest) / shorter(*longest);
    const std::size_t wanted = pieces_wanted(charts, std::size_t(longest - charts.begin()), area);
    if (wanted < 2 || slim < kStrip * double(wanted) / 2) return count;
    std::vector<FlatChart> pieces = cut(input, *longest, wanted);
    if (pieces.empty()) return count;
    const auto at = charts.erase(longest);
    charts.insert(at, std::move_iterator(pieces.begin()), std::move_iterator(pieces.end()));
  }
  return kMostStrips;
}

}  // namespace atlas
