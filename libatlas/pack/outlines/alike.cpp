#include "libatlas/pack/outlines/alike.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "libatlas/core/hull.h"
#include "libatlas/core/portable_math.h"

namespace atlas::pack {
namespace {

// Corners of copies lie this close to each other, as a share of the chart's perimeter.
constexpr double kAlike = 1e-3;
// A chart is compared with this many of the groups that were met last.
constexpr std::size_t kGroups = 8;
// Loops with more corners are not compared, nor are more than so many ways in which the lengths of
// the edges of two loops agree. Polygons with many equal edges would take long.
constexpr std::size_t kMostCorners = 1024, kMostShifts = 16;

// The longest loop of a chart.
struct Loop {
  std::vector<Vec2d> corners;   // relative to their mean
  std::vector<double> lengths;  // of the edges that begin at the corners
  double perimeter = 0, area = 0;
};

// Returns the end of the loop of edges that begins at `begin`.
std::size_t end_of_loop(const ChartOutline& outline, std::size_t begin) {
  std::size_t end = begin + 1;
  while (end < outline.edges.size() && outline.edges[end].from.x == outline.edges[end - 1].to.x &&
         outline.edges[end].from.y == outline.edges[end - 1].to.y &&
         !(outline.edges[end - 1].to.x == outline.edges[begin].from.x &&
           outline.edges[end - 1].to.y == outline.edges[begin].from.y))
    ++end;
  return end;
}

Loop loop_of(const ChartOutline& outline) {
  Loop loop;
  if (!outline.loose.empty() || !(outline.area > 0)) return loop;
  std::size_t from = 0, to = 0;
  for (std::size_t begin = 0; begin < outline.edges.size();) {
    const std::size_t end = end_of_loop(outline, begin);
    double length = 0;
    for (std::size_t i = begin; i < end; ++i)
      length += distance(outline.edges[i].from, outline.edges[i].to);
    if (length > loop.perimeter) {
      loop.perimeter = length;
      from = begin;
      to = end;
    }
    begin = end;
  }
  if (to - from < 3 || to - from > kMostCorners) return loop;
  loop.area = outline.area;
  Vec2d mean{0, 0};
  for (std::size_t i = from; i < to; ++i) {
    const ChartOutline::Edge& e = outline.edges[i];
    loop.corners.push_back(e.from);
    loop.lengths.push_back(distance(e.from, e.to));
    mean = {mean.x + e.from.x / double(to - from), mean.y + e.from.y / double(to - from)};
  }
  for (Vec2d& p : loop.corners) p = {p.x - mean.x, p.y - mean.y};
  return loop;
}

// Two loops, of which corner i + shift of b is compared with corner i of a.
struct Matching {
  const Loop &a, &b;
  std::size_t shift = 0;

  double tolerance() const { return kAlike * a.perimeter; }
  std::size_t in_b(std::size_t i) const {
    const std::size_t n = a.corners.size();
    return i + shift < n ? i + shift : i + shift - n;
  }
};

bool same_lengths(const Matching& m) {
  for (std::size_t i = 0; i < m.a.lengths.size(); ++i)
    if (std::abs(m.a.lengths[i] - m.b.lengths[m.in_b(i)]) > m.tolerance()) return false;
  return true;
}

// Returns the turn after which the corners of b lie on those of a, if there is one. It minimises
// the sum of squared distances.
std::optional<double> turn_between(const Matching& m) {
  double dot = 0, cross = 0;
  for (std::size_t i = 0; i < m.a.corners.size(); ++i) {
    const Vec2d p = m.b.corners[m.in_b(i)], q = m.a.corners[i];
    dot += p.x * q.x + p.y * q.y;
    cross += p.x * q.y - p.y * q.x;
  }
  const double turn = portable::atan2(cross, dot), c = portable::cos(turn), s = portable::sin(turn);
  for (std::size_t i = 0; i < m.a.corners.size(); ++i) {
    const Vec2d p = m.b.corners[m.in_b(i)];
    const Vec2d turned{c * p.x - s * p.y, s * p.x + c * p.y};
    if (distance(turned, m.a.corners[i]) > m.tolerance()) return std::nullopt;
  }
  return turn;
}

std::optional<double> turn_between(const Loop& a, const Loop& b) {
  if (a.corners.size() != b.corners.size() ||
      std::abs(a.perimeter - b.perimeter) > kAlike * a.perimeter ||
      std::abs(a.area - b.area) > 2 * kAlike * a.area)
    return std::nullopt;
  std::size_t tried = 0;
  for (Matching m{a, b}; m.shift < a.corners.size() && tried < kMostShifts; ++m.shift) {
    if (!same_lengths(m)) continue;
    ++tried;
    if (const std::optional<double> turn = turn_between(m)) return turn;
  }
  return std::nullopt;
}

// Puts the charts in ascending order, and makes the turns relative to the first one.
void sort_members(AlikeCharts& group) {
  std::vector<std::pair<std::uint32_t, double>> members;
  for (std::size_t k = 0; k < group.charts.size(); ++k)
    members.emplace_back(group.charts[k], group.turns[k]);
  std::sort(members.begin(), members.end());
  for (std::size_t k = 0; k < members.size(); ++k) {
    group.charts[k] = members[k].first;
    group.turns[k] = members[k].second - members[0].second;
  }
}

}  // namespace

std::vector<AlikeCharts> find_alike(std::span<const ChartOutline> outlines, std::size_t fewest,
                                    const Context& context) {
  std::vector<Loop> loops;
  for (const ChartOutline& o : outlines) loops.push_back(loop_of(o));
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < loops.size(); ++i)
    if (!loops[i].corners.empty()) order.push_back(i);
  // Copies come close to one another.
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
    const std::size_t a = loops[i].corners.size(), b = loops[j].corners.size();
    return a != b ? a > b : loops[i].perimeter > loops[j].perimeter;
  });
  std::vector<AlikeCharts> groups;
  for (const std::uint32_t i : order) {
    if (context.cancelled()) break;
    bool found = false;
    for (std::size_t k = groups.size(); k-- > 0 && k + kGroups >= groups.size() && !found;) {
      const std::optional<double> turn = turn_between(loops[groups[k].charts[0]], loops[i]);
      if (!turn) continue;
      groups[k].charts.push_back(i);
      groups[k].turns.push_back(*turn);
      found = true;
    }
    if (!found) groups.push_back({{i}, {0}});
  }
  for (AlikeCharts& g : groups) sort_members(g);
  std::erase_if(groups, [&](const AlikeCharts& g) { return g.charts.size() < fewest; });
  const auto area = [&](const AlikeCharts& g) {
    return double(g.charts.size()) * outlines[g.charts[0]].area;
  };
  std::stable_sort(groups.begin(), groups.end(),
                   [&](const AlikeCharts& a, const AlikeCharts& b) { return area(a) > area(b); });
  return groups;
}

}  // namespace atlas::pack
