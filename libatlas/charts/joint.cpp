#include "libatlas/charts/joint.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libatlas/charts/hull.h"

namespace atlas {
namespace {

// Lengths of borders are compared in parts of a chart's whole border: where a mesh is symmetric
// many are equal but for rounding.
constexpr double kBorderParts = 1024;

// The half-edge's two ends in the uvs of its chart.
std::array<glm::dvec2, 2> ends(const FlatChart& chart, std::uint32_t h) {
  const auto at = std::lower_bound(chart.triangles.begin(), chart.triangles.end(), h / 3);
  const auto& corners = chart.corners[std::size_t(at - chart.triangles.begin())];
  return {to_glm(chart.uvs[corners[h % 3]]), to_glm(chart.uvs[corners[next_half_edge(h) % 3]])};
}

struct Pair {
  glm::dvec2 from, to;
  double weight;
};

Motion fit(std::span<const Pair> pairs) {
  Motion motion;
  motion.edges = pairs.size() / 2;
  double length = 0;
  glm::dvec2 mean_from(0), mean_to(0);
  for (const Pair& pair : pairs) {
    mean_from += pair.weight * pair.from;
    mean_to += pair.weight * pair.to;
    length += pair.weight;
  }
  if (!(length > 0)) return motion;
  mean_from /= length;
  mean_to /= length;
  double c = 0, s = 0, spread = 0;
  for (const Pair& pair : pairs) {
    const glm::dvec2 p = pair.from - mean_from, q = pair.to - mean_to;
    c += pair.weight * glm::dot(p, q);
    s += pair.weight * (p.x * q.y - p.y * q.x);
    spread += pair.weight * (glm::dot(p, p) + glm::dot(q, q));
  }
  const double norm = std::sqrt(c * c + s * s);
  if (norm > 0) motion.turn = glm::dvec2(c, s) / norm;
  motion.shift = mean_to - to_glm(motion(from_glm(mean_from)));
  motion.misfit = std::sqrt(std::max(spread - 2 * norm, 0.0) / length) / length;
  return motion;
}

}  // namespace

std::vector<BorderEdge> find_border(const Topology& topology, const Partition& partition,
                                    std::span<const std::uint32_t> triangles, std::uint32_t chart) {
  std::vector<BorderEdge> border;
  for (const std::uint32_t t : triangles) {
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const std::uint32_t o = topology.opposite[h];
      if (o == kNoIndex || partition.chart[o / 3] == chart) continue;
      border.push_back({partition.chart[o / 3], h, edge_length(topology, h)});
    }
  }
  std::stable_sort(border.begin(), border.end(),
                   [](const BorderEdge& a, const BorderEdge& b) { return a.other < b.other; });
  return border;
}

std::vector<ChartNeighbour> find_neighbours(std::span<const BorderEdge> border) {
  std::vector<ChartNeighbour> all;
  double whole = 0;
  for (std::size_t first = 0, last = 0; first < border.size(); first = last) {
    ChartNeighbour n{border[first].other, 0, {}};
    for (; last < border.size() && border[last].other == n.chart; ++last) {
      n.border += border[last].length;
    }
    n.edges = border.subspan(first, last - first);
    whole += n.border;
    all.push_back(n);
  }
  for (ChartNeighbour& n : all) n.border = std::round(kBorderParts * n.border / whole);
  std::stable_sort(all.begin(), all.end(), [](const ChartNeighbour& a, const ChartNeighbour& b) {
    return a.border > b.border;
  });
  return all;
}

Joint::Joint(const Topology& topology, const FlatChart& a, const FlatChart& b,
             std::span<const BorderEdge> edges)
    : a_(a), b_(b) {
  std::vector<Pair> pairs;
  for (const BorderEdge& edge : edges) {
    const auto from = ends(a, edge.half_edge), to = ends(b, topology.opposite[edge.half_edge]);
    for (const int i : {0, 1}) pairs.push_back({from[i], to[1 - i], 0.5 * edge.length});
  }
  motion_ = fit(pairs);
}

std::vector<std::uint32_t> Joint::triangles() const {
  std::vector<std::uint32_t> both(triangle_count());
  std::merge(a_.triangles.begin(), a_.triangles.end(), b_.triangles.begin(), b_.triangles.end(),
             both.begin());
  return both;
}

std::vector<Vec2d> Joint::uvs() const {
  std::vector<Vec2d> uvs;
  uvs.reserve(3 * triangle_count());
  const auto &a = a_.triangles, &b = b_.triangles;
  for (std::size_t i = 0, j = 0; i < a.size() || j < b.size();) {
    const bool moved = j == b.size() || (i < a.size() && a[i] < b[j]);
    const auto& corners = moved ? a_.corners[i++] : b_.corners[j++];
    for (const std::uint32_t v : corners) uvs.push_back(moved ? motion_(a_.uvs[v]) : b_.uvs[v]);
  }
  return uvs;
}

double Joint::box() const {
  std::vector<Vec2d> points = b_.uvs, hull;
  for (const Vec2d& p : a_.uvs) points.push_back(motion_(p));
  hull_area(points, hull);
  return box_area(hull);
}

}  // namespace atlas
