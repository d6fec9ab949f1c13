#include "libatlas/simplify/border_chains.h"

#include <algorithm>
#include <numeric>

namespace atlas::simplify {
namespace {

// A border half-edge of one chart between two points. Vertices at equal positions are one point.
struct Side {
  std::uint32_t low, high;  // points
  std::uint32_t chart, half;
};

// The border edges of all charts. All sides between the same two points form one edge.
class BorderGraph {
 public:
  BorderGraph(const Geometry& geometry, const std::vector<FineChart>& charts) : charts_(charts) {
    gather(geometry);
    group();
    connect();
  }

  std::uint32_t edge_count() const { return static_cast<std::uint32_t>(edge_begin_.size() - 1); }
  std::uint32_t side_begin(std::uint32_t edge) const { return edge_begin_[edge]; }
  std::uint32_t side_count(std::uint32_t edge) const {
    return edge_begin_[edge + 1] - edge_begin_[edge];
  }
  const Side& side(std::uint32_t s) const { return sides_[s]; }
  std::uint32_t edge_of(std::uint32_t s) const { return side_edge_[s]; }
  std::uint32_t low(std::uint32_t edge) const { return sides_[edge_begin_[edge]].low; }
  std::uint32_t high(std::uint32_t edge) const { return sides_[edge_begin_[edge]].high; }
  // Whether a chain continues beyond `point`. It does if all sides of the edge continue into the
  // same next edge.
  bool through(std::uint32_t edge, std::uint32_t point) const {
    return through_[std::size_t{2} * edge + (high(edge) == point)];
  }

  // The local vertex of a side at one of its edge's points.
  std::uint32_t vertex_at(std::uint32_t s, std::uint32_t point) const {
    const FineChart& chart = charts_[sides_[s].chart];
    const std::uint32_t from = chart.from(sides_[s].half), to = chart.to(sides_[s].half);
    return point_of(sides_[s].chart, from) == point ? from : to;
  }
  // The other border half-edge at that vertex.
  std::uint32_t across(std::uint32_t s, std::uint32_t point) const {
    const FineChart& chart = charts_[sides_[s].chart];
    const std::uint32_t v = vertex_at(s, point);
    const std::uint32_t half =
        chart.from(sides_[s].half) == v ? chart.border_into(v) : chart.vertex_half[v];
    return find(sides_[s].chart, half);
  }

 private:
  struct Vertex {
    std::uint32_t chart, local, position;
  };
  std::uint32_t point_of(std::uint32_t chart, std::uint32_t local) const {
    const auto begin = vertices_.begin() + chart_begin_[chart],
               end = vertices_.begin() + chart_begin_[chart + 1];
    const auto at = std::lower_bound(begin, end, local,
                                     [](const Vertex& v, std::uint32_t l) { return v.local < l; });
    return vertex_point_[static_cast<std::size_t>(at - vertices_.begin())];
  }
  std::uint32_t find(std::uint32_t chart, std::uint32_t half) const {
    const auto at = std::lower_bound(by_half_.begin(), by_half_.end(), std::pair(chart, half),
                                     [&](std::uint32_t s, const auto& key) {
                                       return std::pair(sides_[s].chart, sides_[s].half) < key;
                                     });
    return *at;
  }
  void weld(const Geometry& geometry);
  void gather(const Geometry& geometry);
  void group();
  void connect();

  const std::vector<FineChart>& charts_;
  std::vector<Vertex> vertices_;             // on borders, by chart and local vertex
  std::vector<std::uint32_t> chart_begin_;   // into vertices_
  std::vector<std::uint32_t> vertex_point_;  // 1 a border vertex
  std::uint32_t point_count_ = 0;
  std::vector<Side> sides_;             // by edge
  std::vector<std::uint32_t> by_half_;  // sides by chart and half-edge
  std::vector<std::uint32_t> edge_begin_, side_edge_;
  std::vector<bool> through_;  // 2 an edge: at low, at high
};

// Gives each border vertex its point. Points are the distinct positions among the border vertices
// (0 and -0 are the same).
void BorderGraph::weld(const Geometry& geometry) {
  std::vector<std::uint32_t> order(vertices_.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto less = [&](std::uint32_t i, std::uint32_t j) {
    const Vec3f &a = geometry.mesh->positions[vertices_[i].position],
                &b = geometry.mesh->positions[vertices_[j].position];
    if (a.x != b.x) return a.x < b.x;
    if (a.y != b.y) return a.y < b.y;
    return a.z < b.z;
  };
  std::sort(order.begin(), order.end(), less);
  vertex_point_.resize(vertices_.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || less(order[i - 1], order[i])) ++point_count_;
    vertex_point_[order[i]] = point_count_ - 1;
  }
}

void BorderGraph::gather(const Geometry& geometry) {
  for (std::uint32_t c = 0; c < charts_.size(); ++c) {
    chart_begin_.push_back(static_cast<std::uint32_t>(vertices_.size()));
    for (std::uint32_t v = 0; v < charts_[c].vertex_count(); ++v) {
      if (charts_[c].border(v)) {
        vertices_.push_back({c, v, geometry.position_of(charts_[c].vertex_uv[v])});
      }
    }
  }
  chart_begin_.push_back(static_cast<std::uint32_t>(vertices_.size()));
  weld(geometry);
  for (const Vertex& v : vertices_) {
    const FineChart& chart = charts_[v.chart];
    const std::uint32_t half = chart.vertex_half[v.local];
    const std::uint32_t a = point_of(v.chart, v.local), b = point_of(v.chart, chart.to(half));
    sides_.push_back({std::min(a, b), std::max(a, b), v.chart, half});
  }
}

void BorderGraph::group() {
  std::sort(sides_.begin(), sides_.end(), [](const Side& a, const Side& b) {
    if (a.low != b.low) return a.low < b.low;
    if (a.high != b.high) return a.high < b.high;
    return a.chart != b.chart ? a.chart < b.chart : a.half < b.half;
  });
  side_edge_.resize(sides_.size());
  for (std::uint32_t s = 0; s < sides_.size(); ++s) {
    if (s == 0 || sides_[s - 1].low != sides_[s].low || sides_[s - 1].high != sides_[s].high) {
      edge_begin_.push_back(s);
    }
    side_edge_[s] = static_cast<std::uint32_t>(edge_begin_.size() - 1);
  }
  edge_begin_.push_back(static_cast<std::uint32_t>(sides_.size()));
  by_half_.resize(sides_.size());
  std::iota(by_half_.begin(), by_half_.end(), 0U);
  std::sort(by_half_.begin(), by_half_.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(sides_[a].chart, sides_[a].half) < std::pair(sides_[b].chart, sides_[b].half);
  });
}

// Finds where chains continue. If other borders pass through the same point, a seam ends there, but
// an open border continues: meshes that meet with different steps share a point now and then, and
// an open border hardly moves.
void BorderGraph::connect() {
  std::vector<std::uint8_t> degree(point_count_, 0);
  for (std::uint32_t e = 0; e < edge_count(); ++e) {
    for (const std::uint32_t p : {low(e), high(e)}) degree[p] = std::min(degree[p] + 1, 3);
  }
  through_.assign(std::size_t{2} * edge_count(), true);
  for (std::uint32_t s = 0; s < sides_.size(); ++s) {
    const std::uint32_t edge = side_edge_[s], count = side_count(edge);
    for (const std::uint32_t p : {sides_[s].low, sides_[s].high}) {
      const std::uint32_t next = side_edge_[across(s, p)];
      const bool same = next == side_edge_[across(side_begin(edge), p)];
      if (!same || next == edge || side_count(next) != count || (degree[p] > 2 && count > 1)) {
        through_[std::size_t{2} * edge + (sides_[s].high == p)] = false;
      }
    }
  }
}

// Walks along the edges of the graph and collects the chains.
class ChainFinder {
 public:
  ChainFinder(const BorderGraph& graph, BorderChains& out)
      : graph_(graph), out_(out), visited_(graph.edge_count(), false) {}

  void run() {
    for (std::uint32_t e = 0; e < graph_.edge_count(); ++e) {
      if (visited_[e]) continue;
      const std::uint32_t low = graph_.low(e), high = graph_.high(e);
      if (!graph_.through(e, low)) {
        walk(e, low);
      } else if (!graph_.through(e, high)) {
        walk(e, high);
      }
    }
    for (std::uint32_t e = 0; e < graph_.edge_count(); ++e) {
      if (!visited_[e]) walk(e, graph_.low(e));
    }
  }

 private:
  std::uint32_t other_end(std::uint32_t edge, std::uint32_t point) const {
    return graph_.low(edge) == point ? graph_.high(edge) : graph_.low(edge);
  }
  void append(std::uint32_t point) {
    for (const std::uint32_t s : sides_) vertices_.push_back(graph_.vertex_at(s, point));
  }
  void walk(std::uint32_t edge, std::uint32_t start) {
    sides_.clear();
    vertices_.clear();
    for (std::uint32_t k = 0; k < graph_.side_count(edge); ++k) {
      sides_.push_back(graph_.side_begin(edge) + k);
    }
    const std::uint32_t first = edge;
    std::uint32_t point = start, slots = 1;
    bool closed = false;
    append(point);
    for (;;) {
      visited_[edge] = true;
      point = other_end(edge, point);
      append(point);
      ++slots;
      if (!graph_.through(edge, point)) break;
      for (std::uint32_t& s : sides_) s = graph_.across(s, point);
      edge = graph_.edge_of(sides_[0]);
      closed = edge == first;
      if (closed) break;
    }
    finish(slots, closed);
  }
  void finish(std::uint32_t slots, bool closed) {
    const std::uint32_t k = static_cast<std::uint32_t>(sides_.size());
    // Around a closed chain the sides may come back exchanged. Then the chain counts as open, and
    // its start stays as both ends.
    closed = closed && std::equal(vertices_.begin(), vertices_.begin() + k, vertices_.end() - k);
    if (closed) {
      --slots;
      vertices_.resize(vertices_.size() - k);
    }
    if (slots < (closed ? 4U : 3U)) return;
    const std::uint32_t chain = static_cast<std::uint32_t>(out_.chains.size());
    out_.chains.push_back({static_cast<std::uint32_t>(out_.slot_chain.size()), slots,
                           static_cast<std::uint32_t>(out_.side_chart.size()), k,
                           out_.vertices.size(), closed});
    out_.slot_chain.insert(out_.slot_chain.end(), slots, chain);
    for (const std::uint32_t s : sides_) out_.side_chart.push_back(graph_.side(s).chart);
    out_.vertices.insert(out_.vertices.end(), vertices_.begin(), vertices_.end());
  }

  const BorderGraph& graph_;
  BorderChains& out_;
  std::vector<bool> visited_;
  std::vector<std::uint32_t> sides_, vertices_;
};

}  // namespace

BorderChains find_border_chains(const Geometry& geometry, const std::vector<FineChart>& charts) {
  BorderChains out;
  const BorderGraph graph(geometry, charts);
  ChainFinder(graph, out).run();
  return out;
}

}  // namespace atlas::simplify
