#include "libatlas/charts/flattening/split.h"

#include <array>
#include <functional>
#include <limits>
#include <queue>

#include "libatlas/core/glm_bridge.h"

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
  return GrownRegions(topology, chart, seeds).take_owners();
}

}  // namespace atlas
