#include "libatlas/charts/flattening/split.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/sort_total.h"

namespace atlas {
namespace {

// Weight of the fold at an edge in the distance across it.
constexpr double kNormalWeight = 8;
constexpr double kUnreached = std::numeric_limits<double>::max();

struct Visit {
  double distance;
  std::uint32_t node, source;
  bool operator>(const Visit& other) const {
    if (distance != other.distance) return distance > other.distance;
    return node != other.node ? node > other.node : source > other.source;
  }
};

glm::dvec3 centroid(const LocalChart& chart, std::uint32_t t) {
  const auto& v = chart.corners[t];
  return (to_glm(chart.positions[v[0]]) + to_glm(chart.positions[v[1]]) +
          to_glm(chart.positions[v[2]])) /
         3.0;
}

double fold(const Topology& topology, const LocalChart& chart, std::uint32_t s, std::uint32_t t) {
  return 1 - glm::dot(to_dvec(topology.normals[chart.triangles()[s]]),
                      to_dvec(topology.normals[chart.triangles()[t]]));
}

// Grows regions over the triangles by Dijkstra's algorithm.
class GrownRegions {
 public:
  GrownRegions(const Topology& topology, const LocalChart& chart,
               std::span<const std::uint32_t> seeds)
      : topology_(topology),
        chart_(chart),
        distance_(chart.corners.size(), kUnreached),
        owner_(chart.corners.size(), 0) {
    // No seed may take another one.
    for (const std::uint32_t seed : seeds) distance_[seed] = 0;
    for (std::uint32_t s = 0; s < seeds.size(); ++s) take({0, seeds[s], s});
    while (!heap_.empty()) {
      const Visit visit = heap_.top();
      heap_.pop();
      if (visit.distance < distance_[visit.node]) take(visit);
    }
  }

  const std::vector<double>& distance() const { return distance_; }
  // One per triangle: the number of the seed that is nearest.
  std::vector<std::uint8_t> take_owners() { return std::move(owner_); }

 private:
  void take(const Visit& visit) {
    distance_[visit.node] = visit.distance;
    owner_[visit.node] = static_cast<std::uint8_t>(visit.source);
    const glm::dvec3 from = centroid(chart_, visit.node);
    for (std::uint32_t h = 3 * visit.node; h < 3 * visit.node + 3; ++h) {
      if (chart_.opposite[h] == kNoIndex) continue;
      const std::uint32_t next = chart_.opposite[h] / 3;
      if (distance_[next] <= visit.distance) continue;
      const double step = glm::distance(from, centroid(chart_, next)) *
                          (1 + kNormalWeight * fold(topology_, chart_, visit.node, next));
      if (visit.distance + step < distance_[next]) {
        heap_.push({visit.distance + step, next, visit.source});
      }
    }
  }

  const Topology& topology_;
  const LocalChart& chart_;
  std::vector<double> distance_;
  std::vector<std::uint8_t> owner_;
  std::priority_queue<Visit, std::vector<Visit>, std::greater<>> heap_;
};

// Gives each polygon to the part that has most of its area. If a single part would be left, one
// polygon goes to another part; a chart of one polygon stays divided by triangles.
void keep_polygons_whole(const Topology& topology, const LocalChart& chart,
                         std::vector<std::uint8_t>& parts) {
  const std::span<const std::uint32_t> triangles = chart.triangles();
  std::vector<std::uint32_t> order(triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto polygon = [&](std::uint32_t i) { return topology.polygon[triangles[i]]; };
  sort_total(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return polygon(a) != polygon(b) ? polygon(a) < polygon(b) : a < b;
  });
  std::vector<std::uint8_t> whole(parts.size());
  struct Spare {
    double area = -1;  // in the part that did not get the polygon
    std::size_t begin = 0, end = 0;
    std::uint8_t part = 0;
  } spare;
  std::vector<double> area(1 + std::size_t(*std::max_element(parts.begin(), parts.end())));
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    std::fill(area.begin(), area.end(), 0);
    for (; end < order.size() && polygon(order[end]) == polygon(order[begin]); ++end)
      area[parts[order[end]]] += topology.areas[triangles[order[end]]];
    const auto most = std::max_element(area.begin(), area.end());
    const auto part = static_cast<std::uint8_t>(most - area.begin());
    for (std::size_t i = begin; i < end; ++i) whole[order[i]] = part;
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint8_t other = parts[order[i]];
      if (other != part && area[other] > spare.area) spare = {area[other], begin, end, other};
    }
  }
  const bool divided =
      std::any_of(whole.begin(), whole.end(), [&](std::uint8_t p) { return p != whole[0]; });
  if (!divided) {
    if (spare.end - spare.begin == order.size()) return;
    for (std::size_t i = spare.begin; i < spare.end; ++i) whole[order[i]] = spare.part;
  }
  parts = std::move(whole);
}

std::uint32_t farthest_from(const Topology& topology, const LocalChart& chart,
                            std::uint32_t start) {
  const GrownRegions region(topology, chart, {&start, 1});
  const std::vector<double>& distance = region.distance();
  std::uint32_t farthest = start;
  for (std::uint32_t t = 0; t < distance.size(); ++t) {
    if (distance[t] < kUnreached && distance[t] > distance[farthest]) farthest = t;
  }
  // All triangles lie in one point: any other one will do.
  if (farthest == start) {
    for (std::uint32_t t = 0; t < distance.size(); ++t) {
      if (t != start && distance[t] < kUnreached) return t;
    }
  }
  return farthest;
}

}  // namespace

std::array<std::uint32_t, 2> far_pair(const Topology& topology, const LocalChart& chart) {
  const std::uint32_t a = farthest_from(topology, chart, 0);
  return {a, farthest_from(topology, chart, a)};
}

std::vector<std::uint8_t> divide(const Topology& topology, const LocalChart& chart,
                                 std::span<const std::uint32_t> seeds) {
  std::vector<std::uint8_t> parts = GrownRegions(topology, chart, seeds).take_owners();
  if (!topology.polygon.empty()) keep_polygons_whole(topology, chart, parts);
  return parts;
}

}  // namespace atlas
