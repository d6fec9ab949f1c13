#include "libatlas/charts/filling/long_charts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numbers>
#include <numeric>
#include <utility>

#include "libatlas/charts/filling/line_cut.h"
#include "libatlas/charts/flattening/part_of_chart.h"
#include "libatlas/param/mesh/halfedges.h"

namespace atlas {
namespace {

constexpr double kLeastFill = 0.75;  // of the smallest possible page
// A strip to be cut into n pieces is at least kStrip n / 2 times as long as wide.
constexpr double kStrip = 4;
constexpr std::size_t kMostStrips = 64;
constexpr std::size_t kMostParts = 2;  // per length
// kBand is how far cuts may stray to either side to be short, as a share of a length; kCrumb, the
// area of parts that stay with a neighbour, likewise.
constexpr double kBand = 0.3, kCrumb = 0.01;
// The most that pieces may have of a chart's length. Long needles along the chart cannot be cut
// across, and would come off one by one.
constexpr double kShorter = 0.9;
// The largest product of the perimeters of all charts' rectangles and the longest side, relative to
// the charts' area. At this value a page of 2048 texels that the longest chart spans needs a
// quarter as much for gutters (1.3 texels on each side of a border) as for charts. Of 796 meshes
// seven exceed it, and their longest charts are each more than twice as long as a square page.
constexpr double kMostGutter = 400;

double longer(const FlatChart& chart) {
  return std::max(chart.size.x, chart.size.y);
}
double shorter(const FlatChart& chart) {
  return std::min(chart.size.x, chart.size.y);
}

// Returns the area of the smallest page for the longest chart and the widest of the others, which
// lies beside it or at its end.
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

// Returns into how many lengths the chart must be cut for the page to be filled.
std::size_t pieces_for_page(const std::vector<FlatChart>& charts, std::size_t longest,
                            double area) {
  const double page = least_page(charts, longest);
  return static_cast<std::size_t>(std::ceil(kLeastFill * page / area));
}

// Returns into how many lengths the chart must be cut for gutters to leave room for charts.
std::size_t pieces_for_gutters(const std::vector<FlatChart>& charts, std::size_t longest,
                               double area) {
  double around = 0;
  for (const FlatChart& chart : charts) around += 2 * (chart.size.x + chart.size.y);
  const double length = longer(charts[longest]);
  if (around * length <= kMostGutter * area) return 1;
  const double side = std::sqrt(area / kLeastFill);
  return static_cast<std::size_t>(std::ceil(length / std::max(side, kMostGutter * area / around)));
}

using Lengths = std::vector<std::vector<std::uint32_t>>;

// Returns the triangles of `count` lengths, about equal ones; nothing if one of them would be
// empty, or when cancelled.
Lengths lengths_of(const FlattenInput& input, const FlatChart& chart, std::size_t count,
                   const Context& context) {
  std::vector<std::uint32_t> all(chart.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  param::HalfEdges half_edges;
  half_edges.build(chart.corners, chart.uvs.size());
  LineCutter cutter(chart, half_edges, all, input.topology.polygon);
  cutter.face(chart.size.x >= chart.size.y ? 0 : std::numbers::pi / 2);
  const double length = (cutter.high() - cutter.low()) / double(count);
  const double crumb = kCrumb * chart.distortion.uv_area / double(count);
  std::vector<std::uint32_t> place(all.size(), 0);
  for (std::size_t k = 1; k < count; ++k) {
    const LineCut cut = cutter.cut(cutter.low() + double(k) * length, kBand * length, crumb);
    if (cut.parts.empty() || context.cancelled()) return {};
    for (const LineCut::Part& part : cut.parts) {
      for (const std::uint32_t t : part.triangles) place[t] += part.beyond;
    }
  }
  Lengths lengths(count);
  for (const std::uint32_t t : all) lengths[place[t]].push_back(t);
  if (std::any_of(lengths.begin(), lengths.end(), [](const auto& l) { return l.empty(); })) {
    return {};
  }
  return lengths;
}

// Returns a length as charts, one if it is connected; nothing if one of them exceeds the bound.
std::vector<FlatChart> charts_of(const FlattenInput& input, const FlatChart& chart,
                                 const std::vector<std::uint32_t>& length) {
  std::vector<FlatChart> pieces;
  for (const std::vector<std::uint32_t>& triangles : connected_parts(chart, length)) {
    pieces.push_back(part_of_chart(input, chart, triangles));
    const Distortion& d = pieces.back().distortion;
    if (d.stretch_999 > input.options.max_stretch || d.flips > 0) return {};
  }
  return pieces;
}

// Makes the lengths charts. A length that exceeds the bound stays with the next one: what stretched
// a thousandth of the whole chart too much may be more of a length. Returns nothing if there is no
// next one, if there are more than kMostParts charts per length, or if one is hardly shorter than
// the whole chart.
std::vector<FlatChart> cut(const FlattenInput& input, const FlatChart& chart, Lengths lengths) {
  std::vector<FlatChart> pieces;
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    std::vector<FlatChart> made = charts_of(input, chart, lengths[k]);
    std::move(made.begin(), made.end(), std::back_inserter(pieces));
    if (!made.empty()) continue;
    if (k + 1 == lengths.size()) return {};
    std::vector<std::uint32_t>& next = lengths[k + 1];
    next.insert(next.end(), lengths[k].begin(), lengths[k].end());
    std::sort(next.begin(), next.end());
  }
  if (pieces.size() < 2 || pieces.size() > kMostParts * lengths.size()) return {};
  const bool all_shorter = std::all_of(pieces.begin(), pieces.end(), [&](const FlatChart& piece) {
    return longer(piece) <= kShorter * longer(chart);
  });
  return all_shorter ? pieces : std::vector<FlatChart>{};
}

}  // namespace

std::size_t cut_long_charts(const FlattenInput& input, std::vector<FlatChart>& charts,
                            const Context& context) {
  if (input.options.min_fill <= 0) return 0;
  double area = 0;
  for (const FlatChart& chart : charts) area += chart.distortion.uv_area;
  for (std::size_t count = 0; count < kMostStrips && charts.size() > 1; ++count) {
    const auto longest = std::max_element(
        charts.begin(), charts.end(),
        [](const FlatChart& a, const FlatChart& b) { return longer(a) < longer(b); });
    const double slim = longer(*longest) / shorter(*longest);
    const auto place = std::size_t(longest - charts.begin());
    const std::size_t wanted =
        std::max(pieces_for_page(charts, place, area), pieces_for_gutters(charts, place, area));
    if (wanted < 2 || slim < kStrip * double(wanted) / 2) return count;
    std::vector<FlatChart> pieces =
        cut(input, *longest, lengths_of(input, *longest, wanted, context));
    if (pieces.empty()) return count;
    const auto at = charts.erase(longest);
    charts.insert(at, std::move_iterator(pieces.begin()), std::move_iterator(pieces.end()));
  }
  return kMostStrips;
}

}  // namespace atlas
