#include "libatlas/charts/seams/band_paths.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>

#include "libatlas/charts/mesh/border_weight.h"

namespace atlas {
namespace {

constexpr double kFar = std::numeric_limits<double>::max();
constexpr double kSteps = 256;  // the length of a mean edge in integer costs

}  // namespace

BandPaths::BandPaths(const Topology& topology, const Partition& partition, double crease_angle)
    : topology_(topology), fans_(topology, partition), crease_angle_(crease_angle) {}

BandPaths::Path BandPaths::beside(const Path& path, const std::pair<Ends, Ends>& ends,
                                  const Band& band) {
  for (const std::uint32_t h : path) add(h, 0);
  add(next_half_edge(path.back()), 0);
  choose_unit(path);
  spread(band.rings);
  Path found = find(ends.first, ends.second, band.stiffness);
  clear();
  return found;
}

BandPaths::Path BandPaths::to_border(std::uint32_t h, int rings) {
  add(h, 0);
  choose_unit({h, next_half_edge(h), previous_half_edge(h)});
  spread(rings);
  Path found = find({h}, {}, 0);
  clear();
  return found;
}

void BandPaths::add(std::uint32_t h, int level) {
  if (level_.empty()) {
    const std::size_t vertices = topology_.points.size();
    distance_.assign(vertices, kFar);
    through_.assign(vertices, kNoIndex);
    out_.assign(vertices, kNoIndex);
    level_.assign(vertices, -1);
  }
  const std::uint32_t v = fans_.from(h);
  if (level_[v] >= 0) return;
  level_[v] = level;
  out_[v] = h;
  band_.push_back(v);
}

// Costs are multiples of a small part of these edges' mean length. Otherwise rounding would choose
// among equally long paths, as on a regular grid.
void BandPaths::choose_unit(const Path& edges) {
  double length = 0;
  for (const std::uint32_t h : edges) length += edge_length(topology_, h);
  unit_ = length > 0 ? length / (kSteps * double(edges.size())) : 1;
}

// Extends the band to all vertices within `rings` edges of those that it holds.
void BandPaths::spread(int rings) {
  const auto linked = [&](std::uint32_t g) { return fans_.linked(g); };
  for (std::size_t i = 0; i < band_.size(); ++i) {
    const std::uint32_t v = band_[i];
    if (level_[v] == rings) continue;
    fans_.around(out_[v], linked, [&](std::uint32_t g) { add(next_half_edge(g), level_[v] + 1); });
  }
}

// Dijkstra's algorithm. Returns a path to the border if `goals` is empty.
BandPaths::Path BandPaths::find(const Ends& starts, const Ends& goals, double stiffness) {
  using Visit = std::pair<double, std::uint32_t>;
  std::priority_queue<Visit, std::vector<Visit>, std::greater<>> heap;
  std::vector<std::uint32_t> first, last;
  for (const std::uint32_t h : starts) {
    const std::uint32_t v = fans_.from(h);
    if (level_[v] < 0) continue;
    first.push_back(v);
    distance_[v] = 0;
    heap.push({0, v});
  }
  for (const std::uint32_t h : goals) last.push_back(fans_.from(h));
  const auto among = [](const std::vector<std::uint32_t>& list, std::uint32_t v) {
    return std::find(list.begin(), list.end(), v) != list.end();
  };
  const auto linked = [&](std::uint32_t g) { return fans_.linked(g); };
  while (!heap.empty()) {
    const double so_far = heap.top().first;
    const std::uint32_t v = heap.top().second;
    heap.pop();
    if (so_far > distance_[v]) continue;
    if (among(last, v)) return trace(v);
    const ChartFans::Place place = fans_.place(out_[v]);
    if (goals.empty() && place == ChartFans::Place::border) return trace(v);
    if (!among(first, v) && place != ChartFans::Place::inside) continue;
    fans_.around(out_[v], linked, [&](std::uint32_t g) {
      const std::uint32_t w = fans_.to(g);
      if (!fans_.linked(g) || level_[w] < 0 || topology_.inner(g)) return;
      const double away = 0.5 * stiffness * (level_[v] + level_[w]) * edge_length(topology_, g);
      const double cost = border_weight(topology_, g, crease_angle_) + away;
      const double next = so_far + std::round(cost / unit_);
      if (next >= distance_[w]) return;
      distance_[w] = next;
      through_[w] = g;
      heap.push({next, w});
    });
  }
  return {};
}

BandPaths::Path BandPaths::trace(std::uint32_t v) const {
  Path path;
  for (; through_[v] != kNoIndex; v = fans_.from(through_[v])) path.push_back(through_[v]);
  std::reverse(path.begin(), path.end());
  return path;
}

void BandPaths::clear() {
  for (const std::uint32_t v : band_) {
    level_[v] = -1;
    out_[v] = through_[v] = kNoIndex;
    distance_[v] = kFar;
  }
  band_.clear();
}

}  // namespace atlas
