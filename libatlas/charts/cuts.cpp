#include <functional>
#include <limits>
#include <queue>

#include "libatlas/charts/split.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

constexpr double kCreaseDiscount = 4;  // how much shorter a fully folded edge is to cut along
// Angle defects below this, in radians, are not what stretches a chart beyond its bound.
constexpr double kLeastDefect = 0.02;
constexpr double kFar = std::numeric_limits<double>::max();

// Shortest paths along a chart's inner edges, between vertices.
class EdgePaths {
 public:
  EdgePaths(const Topology& topology, const LocalChart& chart)
      : topology_(topology), chart_(chart), out_(chart.positions.size(), kNoIndex) {
    for (std::uint32_t h = 0; h < chart.opposite.size(); ++h) {
      if (out_[from(h)] == kNoIndex || chart.opposite[h] == kNoIndex) out_[from(h)] = h;
    }
  }

  std::uint32_t from(std::uint32_t h) const { return chart_.corners[h / 3][h % 3]; }
  bool on_border(std::uint32_t v) const { return chart_.opposite[out_[v]] == kNoIndex; }

  // From the vertices with role 1 to the nearest with role 2, passing only those with role 0;
  // returns the half-edges on the way, empty if there is none.
  std::vector<std::uint32_t> shortest(const std::vector<std::uint8_t>& role) {
    const std::size_t n = chart_.positions.size();
    std::vector<double> distance(n, kFar);
    std::vector<std::uint32_t> through(n, kNoIndex);
    std::vector<std::uint8_t> done(n, 0);
    using Visit = std::pair<double, std::uint32_t>;
    std::priority_queue<Visit, std::vector<Visit>, std::greater<>> heap;
    for (std::uint32_t v = 0; v < n; ++v) {
      if (role[v] != 1) continue;
      distance[v] = 0;
      heap.push({0, v});
    }
    std::vector<std::uint32_t> path;
    while (!heap.empty()) {
      const std::uint32_t v = heap.top().second;
      heap.pop();
      if (done[v]) continue;
      done[v] = 1;
      if (role[v] == 2) {
        for (std::uint32_t w = v; through[w] != kNoIndex; w = from(through[w])) {
          path.push_back(through[w]);
        }
        break;
      }
      each_inner_edge(v, [&](std::uint32_t h) {
        const std::uint32_t to = from(next_half_edge(h));
        const double next = distance[v] + length(h);
        if (role[to] == 1 || next >= distance[to]) return;
        distance[to] = next;
        through[to] = h;
        heap.push({next, to});
      });
    }
    return path;
  }

  // 2 pi less the angles around an inner vertex.
  double defect(std::uint32_t v) const {
    double sum = 2 * M_PI;
    std::uint32_t h = out_[v];
    do {
      const glm::dvec3 p = point(from(h)), a = point(from(next_half_edge(h))) - p,
                       b = point(from(previous_half_edge(h))) - p;
      sum -= std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
      h = chart_.opposite[previous_half_edge(h)];
    } while (h != kNoIndex && h != out_[v]);
    return sum;
  }

 private:
  glm::dvec3 point(std::uint32_t v) const { return to_glm(chart_.positions[v]); }

  double length(std::uint32_t h) const {
    const std::uint32_t s = chart_.triangles()[h / 3],
                        t = chart_.triangles()[chart_.opposite[h] / 3];
    const double fold =
        0.5 * (1 - glm::dot(to_dvec(topology_.normals[s]), to_dvec(topology_.normals[t])));
    return glm::distance(point(from(h)), point(from(next_half_edge(h)))) /
           (1 + kCreaseDiscount * fold);
  }

  // From a border half-edge the walk meets every inner edge of the fan once.
  template <class Body>
  void each_inner_edge(std::uint32_t v, Body&& body) const {
    std::uint32_t h = out_[v];
    do {
      if (chart_.opposite[h] != kNoIndex) body(h);
      h = chart_.opposite[previous_half_edge(h)];
    } while (h != kNoIndex && h != out_[v]);
  }

  const Topology& topology_;
  const LocalChart& chart_;
  std::vector<std::uint32_t> out_;  // a half-edge from each vertex, the one on the border if any
};

void mark_seams(const LocalChart& chart, const std::vector<std::uint32_t>& path,
                Partition& partition) {
  for (const std::uint32_t h : path) {
    for (const std::uint32_t side : {h, chart.opposite[h]}) {
      partition.seams[chart.triangles()[side / 3]] |= static_cast<std::uint8_t>(1u << (side % 3));
    }
  }
}

}  // namespace

bool join_loops(const Topology& topology, const LocalChart& chart, Partition& partition) {
  if (chart.loops.size() < 2) return false;
  EdgePaths paths(topology, chart);
  std::vector<std::uint8_t> role(chart.positions.size(), 0);
  for (std::size_t i = 0; i < chart.loops.size(); ++i) {
    std::uint32_t h = chart.loops[i];
    do {
      role[paths.from(h)] = i == 0 ? 1 : 2;
      h = chart.next_border(h);
    } while (h != chart.loops[i]);
  }
  const std::vector<std::uint32_t> path = paths.shortest(role);
  mark_seams(chart, path, partition);
  return !path.empty();
}

bool cut_to_border(const Topology& topology, const LocalChart& chart,
                   std::span<const std::uint32_t> offenders, Partition& partition) {
  EdgePaths paths(topology, chart);
  std::uint32_t apex = kNoIndex;
  double largest = kLeastDefect;
  for (const std::uint32_t t : offenders) {
    for (const std::uint32_t v : chart.corners[t]) {
      if (paths.on_border(v)) continue;
      const double defect = std::abs(paths.defect(v));
      if (defect <= largest) continue;
      largest = defect;
      apex = v;
    }
  }
  if (apex == kNoIndex) return false;
  std::vector<std::uint8_t> role(chart.positions.size(), 0);
  for (std::uint32_t v = 0; v < role.size(); ++v) role[v] = paths.on_border(v) ? 2 : 0;
  role[apex] = 1;
  const std::vector<std::uint32_t> path = paths.shortest(role);
  mark_seams(chart, path, partition);
  return !path.empty();
}

}  // namespace atlas
