#include "libatlas/charts/flattening/joint.h"

#include <algorithm>
#include <cmath>

#include "libatlas/core/hull.h"

namespace atlas {
std::array<std::uint32_t, 2> ends_of(const FlatChart& chart, std::uint32_t half_edge) {
  const auto at = std::lower_bound(chart.triangles.begin(), chart.triangles.end(), half_edge / 3);
  const auto& corners = chart.corners[std::size_t(at - chart.triangles.begin())];
  return {corners[half_edge % 3], corners[next_half_edge(half_edge) % 3]};
}

double length_of(std::span<const BorderEdge> edges) {
  double sum = 0;
  for (const BorderEdge& edge : edges) sum += edge.length;
  return sum;
}

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
    while (last < border.size() && border[last].other == n.chart) ++last;
    n.edges = border.subspan(first, last - first);
    n.border = length_of(n.edges);
    whole += n.border;
    all.push_back(n);
  }
  for (ChartNeighbour& n : all) n.border = std::round(kBorderParts * n.border / whole);
  std::stable_sort(all.begin(), all.end(), [](const ChartNeighbour& a, const ChartNeighbour& b) {
    return a.border > b.border;
  });
  return all;
}

Joint::Joint(const Topology& topology, const ChartPair& pair, std::span<const BorderEdge> edges)
    : topology_(topology), a_(pair.a), b_(pair.b), edges_(edges) {
  const auto own = [&](const BorderEdge& edge, int end) {
    return to_glm(a_.uvs[ends_of(a_, edge.half_edge)[end]]);
  };
  const auto other = [&](const BorderEdge& edge, int end) {
    return to_glm(b_.uvs[ends_of(b_, topology.opposite[edge.half_edge])[1 - end]]);
  };
  RigidFit fit(own(edges[0], 0), other(edges[0], 0));
  for (const BorderEdge& edge : edges) {
    for (const int end : {0, 1}) fit.add(own(edge, end), other(edge, end), 0.5 * edge.length);
  }
  motion_ = fit.motion();
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

double Joint::box(const Outline& a, const Outline& b) const {
  std::vector<Vec2d> points = b.hull, hull;
  for (const Vec2d& p : a.hull) points.push_back(motion_(p));
  hull_area(points, hull);
  return box_area(hull);
}

std::size_t Joint::overlap(const Outline& a, const Outline& b, std::size_t most) const {
  std::vector<std::uint32_t> glued;
  for (const BorderEdge& edge : edges_) {
    glued.push_back(edge.half_edge);
    glued.push_back(topology_.opposite[edge.half_edge]);
  }
  std::sort(glued.begin(), glued.end());
  const auto free = [&](std::uint32_t h) {
    return !std::binary_search(glued.begin(), glued.end(), h);
  };
  std::vector<Outline::Edge> still, moved;
  for (const Outline::Edge& e : b.edges) {
    if (free(e.half_edge)) still.push_back(e);
  }
  const auto add = [&](std::uint32_t h, const Vec2d& from, const Vec2d& to) {
    if (free(h)) moved.push_back({h, motion_(from), motion_(to)});
  };
  for (const Outline::Edge& e : a.edges) add(e.half_edge, e.from, e.to);
  if (count_crossings(moved, still, 1) == 0) return 0;
  moved.clear();
  for (std::size_t i = 0; i < a_.triangles.size(); ++i) {
    const auto& v = a_.corners[i];
    for (std::uint32_t c = 0; c < 3; ++c) {
      add(3 * a_.triangles[i] + c, a_.uvs[v[c]], a_.uvs[v[(c + 1) % 3]]);
    }
  }
  return count_crossings(moved, still, most);
}

}  // namespace atlas
