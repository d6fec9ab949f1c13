#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>
#include <unordered_map>

#include "libatlas/charts/flattening/split.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/predicates.h"

namespace atlas {
namespace {

// The darts of one chart, as a graph on the vertices of the mesh.
class CutGraph {
 public:
  CutGraph(const Topology& topology, const LocalChart& chart, Partition& partition, Darts& darts)
      : topology_(topology), partition_(partition), darts_(darts) {
    for (std::uint32_t i = 0; i < chart.opposite.size(); ++i) {
      if (chart.opposite[i] != kNoIndex) continue;
      const std::uint32_t h = 3 * chart.triangles()[i / 3] + i % 3;
      if (!is_dart(h)) {
        node(from(h)).outer = node(to(h)).outer = true;
      } else if (h < topology.opposite[h]) {
        edges_.push_back(h);
      }
    }
  }

  // Closes the darts at these triangles, and the parts of darts that then lead nowhere. Returns
  // whether there were any.
  bool zip(std::span<const std::uint32_t> triangles) {
    bool any = false;
    for (const std::uint32_t t : triangles) {
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        if (!is_dart(h)) continue;
        node(from(h)).zipped = node(to(h)).zipped = true;
        close(h);
        any = true;
      }
    }
    if (any) drop_idle();
    return any;
  }

 private:
  struct Node {
    std::uint32_t parent = kNoIndex, edges = 0;
    bool outer = false, zipped = false;
    std::uint32_t tree_edges = 0, tips = 0;  // of a root: in its tree
    bool anchored = false;
  };

  std::uint32_t from(std::uint32_t h) const { return topology_.corner_vertex[h]; }
  std::uint32_t to(std::uint32_t h) const { return topology_.corner_vertex[next_half_edge(h)]; }

  Node& node(std::uint32_t v) {
    const auto [at, fresh] = nodes_.try_emplace(v);
    if (fresh) at->second.parent = v;
    return at->second;
  }
  std::uint32_t root(std::uint32_t v) {
    while (node(v).parent != v) v = node(v).parent = node(node(v).parent).parent;
    return v;
  }

  std::uint32_t edge(std::uint32_t h) const { return std::min(h, topology_.opposite[h]); }

  bool is_dart(std::uint32_t h) const { return partition_.seam(h) && darts_.cut.contains(edge(h)); }

  void close(std::uint32_t h) {
    darts_.closed.insert(edge(h));
    partition_.close(h);
    partition_.close(topology_.opposite[h]);
  }

  // Closes trees of cuts that open nothing: those without a tip of their own, and single edges away
  // from the border.
  void drop_idle() {
    std::erase_if(edges_, [&](std::uint32_t h) { return !partition_.seam(h); });
    for (const std::uint32_t h : edges_) {
      ++node(from(h)).edges;
      ++node(to(h)).edges;
      node(root(from(h))).parent = root(to(h));
    }
    for (const std::uint32_t h : edges_) {
      Node& tree = node(root(from(h)));
      ++tree.tree_edges;
      for (const std::uint32_t v : {from(h), to(h)}) {
        tree.anchored = tree.anchored || node(v).outer;
        tree.tips += node(v).edges == 1 && !node(v).outer && !node(v).zipped;
      }
    }
    for (const std::uint32_t h : edges_) {
      const Node& tree = node(root(from(h)));
      if (tree.tips == 0 || (tree.tree_edges == 1 && !tree.anchored)) close(h);
    }
  }

  const Topology& topology_;
  Partition& partition_;
  Darts& darts_;
  std::vector<std::uint32_t> edges_;
  std::unordered_map<std::uint32_t, Node> nodes_;
};

// The lexicographically lowest corner of a boundary loop. turn: 1 to the left, -1 to the right.
struct Corner {
  Vec2d at{std::numeric_limits<double>::infinity(), 0};
  int turn = 0;

  bool operator<(const Corner& o) const { return at.x != o.at.x ? at.x < o.at.x : at.y < o.at.y; }
};

Corner lowest_corner(const LocalChart& chart, std::span<const Vec2d> uvs, std::uint32_t loop) {
  const auto uv = [&](std::uint32_t h) { return uvs[chart.corners[h / 3][h % 3]]; };
  Corner lowest;
  std::uint32_t h = loop;
  do {
    const std::uint32_t next = chart.next_border(h);
    if (Corner{uv(next)} < lowest) {
      lowest = {uv(next), orientation(uv(h), uv(next), uv(next_half_edge(next)))};
    }
    h = next;
  } while (h != loop);
  return lowest;
}

}  // namespace

bool Darts::close_crossed(const Topology& topology, const LocalChart& chart,
                          std::span<const BorderCrossing> crossings, Partition& partition) {
  std::vector<std::uint32_t> triangles;
  for (const BorderCrossing& crossing : crossings) {
    triangles.push_back(chart.triangles()[crossing.triangle_a]);
    triangles.push_back(chart.triangles()[crossing.triangle_b]);
  }
  return CutGraph(topology, chart, partition, *this).zip(triangles);
}

bool close_flat_slits(const Topology& topology, const LocalChart& chart, std::span<const Vec2d> uvs,
                      Partition& partition) {
  constexpr double kSameBank = 1e-6;  // relative to the edge's length
  const auto at = [&](std::uint32_t h) { return to_glm(uvs[chart.corners[h / 3][h % 3]]); };
  bool any = false;
  for (std::uint32_t h = 0; h < chart.opposite.size(); ++h) {
    const std::uint32_t own = 3 * chart.triangles()[h / 3] + h % 3;
    if (chart.opposite[h] != kNoIndex || !partition.seam(own)) continue;
    const std::uint32_t other = topology.opposite[own];
    const std::uint32_t o = 3 * partition.local[other / 3] + other % 3;
    const double most = kSameBank * glm::distance(at(h), at(next_half_edge(h)));
    if (glm::distance(at(h), at(next_half_edge(o))) > most ||
        glm::distance(at(next_half_edge(h)), at(o)) > most) {
      continue;
    }
    partition.close(own);
    partition.close(other);
    any = true;
  }
  return any;
}

std::vector<BorderCrossing> turned_loops(const LocalChart& chart, std::span<const Vec2d> uvs) {
  std::vector<Corner> corners;
  for (const std::uint32_t loop : chart.loops) corners.push_back(lowest_corner(chart, uvs, loop));
  std::size_t outline = 0;  // the outer loop reaches farther than the ones inside
  for (std::size_t i = 1; i < corners.size(); ++i) {
    if (corners[i] < corners[outline]) outline = i;
  }
  std::vector<BorderCrossing> all;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (i == outline || corners[i].turn <= 0) continue;
    std::uint32_t h = chart.loops[i];
    do {
      all.push_back({{}, {}, h / 3, h / 3});
      h = chart.next_border(h);
    } while (h != chart.loops[i]);
  }
  return all;
}

}  // namespace atlas
