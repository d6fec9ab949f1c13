#include "libatlas/charts/flattening/split.h"

#include <algorithm>
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
// Where a shape is symmetric, rounding does not choose between distances that are the same.
constexpr double kMore = 1 + 1e-6;
constexpr double kUnreached = std::numeric_limits<double>::max();

struct Visit {
  double distance;
  std::uint32_t node;
  bool operator>(const Visit& other) const {
    return distance != other.distance ? distance > other.distance : node > other.node;
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

// Returns the distance of each triangle along the surface, longer across folds (Dijkstra's
// algorithm).
std::vector<double> distances_from(const Topology& topology, const LocalChart& chart,
                                   std::uint32_t start) {
  std::vector<double> distance(chart.corners.size(), kUnreached);
  std::priority_queue<Visit, std::vector<Visit>, std::greater<>> heap;
  distance[start] = 0;
  heap.push({0, start});
  while (!heap.empty()) {
    const auto [so_far, t] = heap.top();
    heap.pop();
    if (so_far > distance[t]) continue;
    const glm::dvec3 from = centroid(chart, t);
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      if (chart.opposite[h] == kNoIndex) continue;
      const std::uint32_t next = chart.opposite[h] / 3;
      const double step = glm::distance(from, centroid(chart, next)) *
                          (1 + kNormalWeight * fold(topology, chart, t, next));
      if (so_far + step >= distance[next]) continue;
      distance[next] = so_far + step;
      heap.push({so_far + step, next});
    }
  }
  return distance;
}

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

// Returns the triangle with the largest distance. Where all lie in one point, any but `start` will
// do.
std::uint32_t farthest(std::span<const double> distance, std::uint32_t start) {
  std::uint32_t far = start == 0 && distance.size() > 1 ? 1 : 0;
  for (std::uint32_t t = 0; t < distance.size(); ++t) {
    if (distance[t] < kUnreached && distance[t] > kMore * distance[far]) far = t;
  }
  return far;
}

}  // namespace

std::vector<std::uint8_t> halves(const Topology& topology, const LocalChart& chart,
                                 std::span<const std::uint32_t> offenders) {
  const std::uint32_t a = farthest(distances_from(topology, chart, 0), 0);
  const std::vector<double> from_a = distances_from(topology, chart, a);
  const std::uint32_t b = farthest(from_a, a);
  const std::vector<double> from_b = distances_from(topology, chart, b);
  double sum = 0, area = 0;
  for (const std::uint32_t t : offenders) {
    const double own = topology.areas[chart.triangles()[t]];
    sum += own * (from_a[t] - from_b[t]);
    area += own;
  }
  // All triangles on a shortest way to a, or b, are on its side, so both sides are connected.
  const double middle = area > 0 ? sum / area : 0;
  const double least = (kMore - 1) * from_a[b];
  std::vector<std::uint8_t> parts(from_a.size());
  for (std::size_t t = 0; t < parts.size(); ++t) parts[t] = from_a[t] - from_b[t] - middle > least;
  parts[a] = 0;
  parts[b] = 1;
  if (!topology.polygon.empty()) keep_polygons_whole(topology, chart, parts);
  return parts;
}

}  // namespace atlas
