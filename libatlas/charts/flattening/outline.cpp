#include "libatlas/charts/flattening/outline.h"

#include <algorithm>
#include <array>

#include "libatlas/charts/mesh/chart_fans.h"
#include "libatlas/core/bounds.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/hull.h"

namespace atlas {
namespace {

using Box = Bounds<glm::dvec2>;

Box box_of(const Outline::Edge& edge) {
  Box box;
  box.add(to_glm(edge.from));
  box.add(to_glm(edge.to));
  return box;
}

Box box_around(std::span<const Outline::Edge> edges) {
  Box all;
  for (const Outline::Edge& edge : edges) {
    all.add(to_glm(edge.from));
    all.add(to_glm(edge.to));
  }
  return all;
}

struct Swept {
  Box box;
  const Outline::Edge* edge;
  int side;  // 0: an edge of a, 1: an edge of b
};

void add_near(std::span<const Outline::Edge> edges, const Box& near, int side,
              std::vector<Swept>& out) {
  for (const Outline::Edge& edge : edges) {
    const Box box = box_of(edge);
    if (box.meets(near)) out.push_back({box, &edge, side});
  }
}

}  // namespace

Outline outline_of(const Topology& topology, const Partition& partition, const FlatChart& chart) {
  Outline outline;
  const ChartFans fans(topology, partition);
  for (std::size_t i = 0; i < chart.triangles.size(); ++i) {
    for (std::uint32_t c = 0; c < 3; ++c) {
      const std::uint32_t h = 3 * chart.triangles[i] + c;
      if (fans.linked(h)) continue;
      const auto& v = chart.corners[i];
      outline.edges.push_back({h, chart.uvs[v[c]], chart.uvs[v[(c + 1) % 3]]});
    }
  }
  std::vector<Vec2d> points;
  points.reserve(outline.edges.size());
  for (const Outline::Edge& edge : outline.edges) points.push_back(edge.from);
  hull_area(points, outline.hull);
  return outline;
}

// A sweep along u over the edges near both sets.
std::size_t count_crossings(std::span<const Outline::Edge> a, std::span<const Outline::Edge> b,
                            std::size_t most) {
  std::vector<Swept> edges;
  add_near(a, box_around(b), 0, edges);
  add_near(b, box_around(a), 1, edges);
  std::stable_sort(edges.begin(), edges.end(),
                   [](const Swept& s, const Swept& t) { return s.box.low.x < t.box.low.x; });
  std::array<std::vector<const Swept*>, 2> open;  // those that may reach further to the right
  std::size_t count = 0;
  for (const Swept& edge : edges) {
    auto& others = open[1 - edge.side];
    std::erase_if(others, [&](const Swept* other) { return other->box.high.x < edge.box.low.x; });
    for (const Swept* other : others) {
      const Outline::Edge &e = *edge.edge, &f = *other->edge;
      if (edge.box.meets(other->box) && cross_each_other(e.from, e.to, f.from, f.to) &&
          ++count >= most) {
        return count;
      }
    }
    open[edge.side].push_back(&edge);
  }
  return count;
}

}  // namespace atlas
