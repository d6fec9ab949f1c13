#include "libatlas/charts/long_charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <utility>

#include "libatlas/charts/part_of_chart.h"

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

// Whether triangles, as places in the chart's list, hang together.
bool connected(const FlatChart& chart, const std::vector<std::uint32_t>& triangles) {
  std::map<std::array<std::uint32_t, 2>, std::uint32_t> sides;  // by the half-edge's ends
  for (const std::uint32_t t : triangles) {
    for (int c = 0; c < 3; ++c) {
      sides[{chart.corners[t][c], chart.corners[t][(c + 1) % 3]}] = t;
    }
  }
  std::vector<std::uint32_t> queue{triangles.front()};
  std::vector<bool> seen(chart.triangles.size(), false);
  seen[queue[0]] = true;
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const auto& v = chart.corners[queue[i]];
    for (int c = 0; c < 3; ++c) {
      const auto other = sides.find({v[(c + 1) % 3], v[c]});
      if (other == sides.end() || seen[other->second]) continue;
      seen[other->second] = true;
      queue.push_back(other->second);
    }
  }
  return queue.size() == triangles.size();
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
    if (triangles.empty() || !connected(chart, triangles)) return {};
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
