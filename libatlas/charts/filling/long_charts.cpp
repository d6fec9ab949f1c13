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

// The least page for the longest chart and the widest of the others, above it or at its end.
double least_page(const std::vector<FlatChart>& charts, std::size_t longest) {
  std::size_t widest = longest;
  for (std::size_t k = 0; k < charts.size(); ++k) {
    if (k != longest && (widest == longest || shorter(charts[k]) > shorter(charts[widest]))) {
      widest = k;
    }
  }
  const FlatChart &strip = charts[longest], &other = charts[widest];
  return std::min(longer(strip) * (shorter(strip) + shorter(other)),
                  (longer(strip) + shorter(other)) * std::max(shorter(strip), longer(other)));
}

// Into how many lengths the chart must be cut for the page to be filled.
std::size_t pieces_wanted(const std::vector<FlatChart>& charts, std::size_t longest, double area) {
  const double page = least_page(charts, longest);
  return static_cast<std::size_t>(std::ceil(kLeastFill * page / area));
}

// Where a triangle's middle lies along the chart, 0..1.
double place_along(const FlatChart& chart, std::uint32_t triangle) {
  double middle = 0;
  for (const std::uint32_t v : chart.corners[triangle]) {
    middle += (chart.size.x >= chart.size.y ? chart.uvs[v].x : chart.uvs[v].y) / 3;
  }
  return std::clamp(middle / longer(chart), 0.0, 1.0);
}

using Lengths = std::vector<std::vector<std::uint32_t>>;

// A cut between triangles leaves some beside their length where the border is ragged: these go to
// the next one.
void move_strays(const FlatChart& chart, Lengths& lengths) {
  const std::size_t count = lengths.size();
  Lengths moved(count);
  for (std::size_t k = 0; k < count; ++k) {
    Lengths parts = connected_parts(chart, lengths[k]);
    const auto main = std::max_element(
        parts.begin(), parts.end(),
        [](const auto& one, const auto& other) { return one.size() < other.size(); });
    for (auto part = parts.begin(); part != parts.end(); ++part) {
      const double place = double(count) * place_along(chart, part->front()) - double(k);
      const bool back = k + 1 == count || (k > 0 && place < 0.5);
      std::vector<std::uint32_t>& length = moved[part == main ? k : back ? k - 1 : k + 1];
      length.insert(length.end(), part->begin(), part->end());
    }
  }
  for (std::vector<std::uint32_t>& length : moved) std::sort(length.begin(), length.end());
  lengths = std::move(moved);
}

// The triangles of each of `count` equal lengths; none if one of them would come apart.
Lengths lengths_of(const FlatChart& chart, std::size_t count) {
  Lengths lengths(count);
  for (std::uint32_t i = 0; i < chart.corners.size(); ++i) {
    const auto place = static_cast<std::size_t>(double(count) * place_along(chart, i));
    lengths[std::min(count - 1, place)].push_back(i);
  }
  if (std::any_of(lengths.begin(), lengths.end(), [](const auto& l) { return l.empty(); })) {
    return {};
  }
  move_strays(chart, lengths);
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
