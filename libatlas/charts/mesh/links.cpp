#include "libatlas/charts/mesh/links.h"

#include <algorithm>
#include <array>
#include <vector>

#include "libatlas/charts/mesh/fan_pairs.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/predicates.h"
#include "libatlas/core/sort_total.h"

namespace atlas {
namespace {

glm::dvec3 corner_point(const Topology& topology, std::uint32_t corner) {
  return to_dvec(topology.points[topology.corner_vertex[corner]]);
}

// Links half-edges that share an edge.
class Linker {
 public:
  Linker(const MeshView& mesh, const TopologyOptions& options, Topology& topology)
      : mesh_(mesh), options_(options), topology_(topology) {}

  void run() {
    sort_by_lower_vertex();
    duplicate_.assign(topology_.triangle_count(), 0);
    for (std::uint32_t h = 0; h < topology_.opposite.size(); ++h) {
      const std::uint32_t o = topology_.opposite[h];
      if (o == kNoIndex || o < h) continue;
      topology_.opposite[h] = topology_.opposite[o] = kNoIndex;
      if (!topology_.degenerate(h / 3) && !topology_.degenerate(o / 3)) link_pair(h, o);
    }
    for (std::size_t v = 0; v + 1 < first_.size(); ++v)
      link_bucket(edges_.data() + first_[v], edges_.data() + first_[v + 1]);
    link_lone_fins();
  }

  bool needs_turning() const { return topology_.defects.misoriented_edges > 0; }

 private:
  struct Edge {
    std::uint32_t upper, half_edge;
  };

  // Coincident triangles of opposite orientation, at an edge of these two alone or of a fan.
  struct Fin {
    std::uint32_t g, h;
    bool fan;
  };

  std::uint32_t from(std::uint32_t h) const { return topology_.corner_vertex[h]; }
  std::uint32_t to(std::uint32_t h) const { return topology_.corner_vertex[next_half_edge(h)]; }
  std::uint32_t third(std::uint32_t h) const {
    return topology_.corner_vertex[previous_half_edge(h)];
  }

  // Sorts the half-edges that are not in pairs.
  void sort_by_lower_vertex() {
    const auto n = static_cast<std::uint32_t>(topology_.corner_vertex.size());
    first_.assign(topology_.points.size() + 2, 0);
    const auto each = [&](auto&& body) {
      for (std::uint32_t t = 0; t < n / 3; ++t) {
        if (topology_.degenerate(t)) continue;
        for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
          if (topology_.opposite[h] != kNoIndex) continue;
          const std::uint32_t a = from(h), b = to(h);
          body(std::min(a, b), std::max(a, b), h);
        }
      }
    };
    each([&](std::uint32_t low, std::uint32_t, std::uint32_t) { ++first_[low + 2]; });
    for (std::size_t i = 2; i < first_.size(); ++i) first_[i] += first_[i - 1];
    edges_.resize(first_.back());
    each([&](std::uint32_t low, std::uint32_t high, std::uint32_t h) {
      edges_[first_[low + 1]++] = {high, h};
    });
    first_.pop_back();
  }

  void link_bucket(Edge* begin, Edge* end) {
    const auto order = [](const Edge& a, const Edge& b) {
      return a.upper != b.upper ? a.upper < b.upper : a.half_edge < b.half_edge;
    };
    if (end - begin <= 12) {
      // Insertion sort: most buckets hold three to six entries.
      for (Edge* i = begin; i < end; ++i) {
        const Edge moved = *i;
        Edge* j = i;
        for (; j > begin && order(moved, j[-1]); --j) *j = j[-1];
        *j = moved;
      }
    } else {
      sort_total(begin, end, order);
    }
    for (Edge *i = begin, *j = begin; i < end; i = j) {
      while (j < end && j->upper == i->upper) ++j;
      if (j - i == 2) {
        link_pair(i[0].half_edge, i[1].half_edge);
      } else if (j - i > 2) {
        link_fan(i, j);
      }
    }
  }

  void link_pair(std::uint32_t g, std::uint32_t h) {
    if (third(g) == third(h)) {
      if (topology_.thin(g / 3)) return;
      mark_duplicate(g, h);
      if (from(g) != from(h)) {
        fins_.push_back({g, h, false});
      } else {
        topology_.cut_length += length(g);
      }
    } else if (!may_link(g, h)) {
      // A triangle without area that given charts leave out is laid on the other one.
      const bool thin = topology_.thin(g / 3) || topology_.thin(h / 3);
      if (!thin || !options_.cut_at_uv_seams) topology_.cut_length += length(g);
    } else {
      link(g, h);
    }
  }

  // Not inlined, since the loop over all edges takes a thirtieth longer around it.
  [[gnu::noinline]] void link_fan(Edge* begin, Edge* end) {
    // Triangles without area lie in no direction around the edge.
    end = std::stable_partition(begin, end,
                                [&](const Edge& e) { return !topology_.thin(e.half_edge / 3); });
    if (end - begin == 2) return link_pair(begin[0].half_edge, begin[1].half_edge);
    if (end - begin < 2) return;
    ++topology_.defects.nonmanifold_edges;
    fan_.clear();
    for (const Edge* e = begin; e < end; ++e) {
      const std::uint32_t h = e->half_edge;
      fan_.push_back({h, third(h), from(h) < to(h), wing(h), to_dvec(topology_.normals[h / 3])});
    }
    sort_total(fan_.begin(), fan_.end(), [](const FanFace& a, const FanFace& b) {
      return a.third != b.third ? a.third < b.third : a.half_edge < b.half_edge;
    });
    for (std::size_t i = 1; i < fan_.size(); ++i) {
      if (fan_[i].third != fan_[i - 1].third) continue;
      mark_duplicate(fan_[i - 1].half_edge, fan_[i].half_edge);
    }
    if (!topology_.polygon.empty()) link_polygons();
    const auto allowed = [&](std::uint32_t g, std::uint32_t h) { return may_link(g, h); };
    for (const auto& [g, h] : pairing_.run(fan_, allowed)) {
      link(g, h);
      topology_.fan_links.push_back(std::min(g, h));
    }
    for (std::size_t i = 1; i < fan_.size(); ++i) {
      const FanFace &a = fan_[i - 1], &b = fan_[i];
      if (a.third != b.third || a.layer != b.layer) continue;
      fins_.push_back({a.half_edge, b.half_edge, true});
    }
  }

  // Links the triangles of a fan that continue each other inside a polygon, and removes them from
  // the fan.
  void link_polygons() {
    std::vector<bool> linked(fan_.size(), false);
    for (std::size_t i = 0; i < fan_.size(); ++i) {
      for (std::size_t j = i + 1; j < fan_.size() && !linked[i]; ++j) {
        const FanFace &a = fan_[i], &b = fan_[j];
        const bool one =
            topology_.polygon[a.half_edge / 3] == topology_.polygon[b.half_edge / 3] && !linked[j];
        if (!one || a.forward == b.forward || a.third == b.third) continue;
        if (!may_link(a.half_edge, b.half_edge)) continue;
        link(a.half_edge, b.half_edge);
        topology_.fan_links.push_back(std::min(a.half_edge, b.half_edge));
        linked[i] = linked[j] = true;
      }
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < fan_.size(); ++i)
      if (!linked[i]) fan_[kept++] = fan_[i];
    fan_.resize(kept);
  }

  // Coincident triangles of opposite orientation that nothing else continues are the two sides of a
  // fin of one triangle. Scans that were merged from volumes have thousands of these. Linked at
  // their longest edge, they become one chart instead of two.
  void link_lone_fins() {
    for (const Fin& fin : fins_) {
      const bool joined = longest(fin.g) && alone(fin.g / 3) && alone(fin.h / 3) && unfolds(fin);
      if (joined) link(fin.g, fin.h);
      if (joined && fin.fan) topology_.fan_links.push_back(std::min(fin.g, fin.h));
      if (!joined && !fin.fan) topology_.cut_length += length(fin.g);
    }
  }

  // Given texcoords may lay the two sides upon each other. Then they are two charts.
  bool unfolds(const Fin& fin) const {
    if (!may_link(fin.g, fin.h)) return false;
    return !options_.cut_at_uv_seams || mesh_.texcoord_indices.empty() ||
           !same_texcoord(previous_half_edge(fin.g), previous_half_edge(fin.h));
  }

  bool alone(std::uint32_t t) const {
    const std::uint32_t* across = topology_.opposite.data() + 3 * std::size_t{t};
    return across[0] == kNoIndex && across[1] == kNoIndex && across[2] == kNoIndex;
  }

  // Whether h is the longest half-edge of its triangle. Coincident triangles agree on it.
  bool longest(std::uint32_t h) const {
    const double own = edge_length(topology_, h);
    for (const std::uint32_t other : {next_half_edge(h), previous_half_edge(h)}) {
      const double length = edge_length(topology_, other);
      if (length > own || (length == own && third(other) < third(h))) return false;
    }
    return true;
  }

  // Returns the unit direction, perpendicular to the edge, in which the triangle of h lies.
  glm::dvec3 wing(std::uint32_t h) const {
    const std::uint32_t low = from(h) < to(h) ? h : next_half_edge(h);
    const std::uint32_t high = from(h) < to(h) ? next_half_edge(h) : h;
    const glm::dvec3 a = corner_point(topology_, low),
                     edge = glm::normalize(corner_point(topology_, high) - a);
    const glm::dvec3 d = corner_point(topology_, previous_half_edge(h)) - a;
    return glm::normalize(d - glm::dot(d, edge) * edge);
  }

  bool may_link(std::uint32_t g, std::uint32_t h) const {
    if (!mesh_.seams.empty() && (mesh_.seams[g] || mesh_.seams[h])) return false;
    const std::uint32_t s = g / 3, t = h / 3;
    const bool border = !mesh_.materials.empty() && mesh_.materials[s] != mesh_.materials[t];
    if (options_.cut_at_materials && border) return false;
    if (!options_.cut_at_uv_seams || mesh_.texcoord_indices.empty()) return true;
    if (border && aspect(s) != aspect(t)) return false;
    const bool aligned = from(g) == from(h);
    if ((topology_.thin(s) || topology_.thin(t)) && turn(s) * turn(t) != (aligned ? -1 : 1))
      return false;  // would fold a chart that is usable without it
    return same_texcoord(g, aligned ? h : next_half_edge(h)) &&
           same_texcoord(next_half_edge(g), aligned ? next_half_edge(h) : h);
  }

  // Returns in which sense the given texcoords run around a triangle; 0: in none.
  int turn(std::uint32_t t) const {
    std::array<Vec2d, 3> p;
    for (std::uint32_t c = 0; c < 3; ++c) {
      const std::uint32_t i = mesh_.texcoord_indices[3 * std::size_t{t} + c];
      if (i >= mesh_.texcoords.size()) return 0;
      p[c] = {mesh_.texcoords[i].x, mesh_.texcoords[i].y};
    }
    return orientation(p[0], p[1], p[2]);
  }

  double aspect(std::uint32_t t) const { return options_.uv_aspects.of(mesh_.materials[t]); }

  bool same_texcoord(std::uint32_t i, std::uint32_t j) const {
    const std::uint32_t a = mesh_.texcoord_indices[i], b = mesh_.texcoord_indices[j];
    if (a == b) return true;
    const std::size_t n = mesh_.texcoords.size();
    return a < n && b < n && mesh_.texcoords[a] == mesh_.texcoords[b];
  }

  double length(std::uint32_t h) const {
    return glm::distance(corner_point(topology_, h), corner_point(topology_, next_half_edge(h))) /
           topology_.scale;
  }

  void mark_duplicate(std::uint32_t g, std::uint32_t h) {
    std::uint8_t& mark = duplicate_[std::max(g, h) / 3];
    if (!mark) ++topology_.defects.duplicate_triangles;
    mark = 1;
  }

  void link(std::uint32_t g, std::uint32_t h) {
    topology_.opposite[g] = h;
    topology_.opposite[h] = g;
    if (from(g) == from(h)) ++topology_.defects.misoriented_edges;
  }

  const MeshView& mesh_;
  const TopologyOptions& options_;
  Topology& topology_;
  std::vector<std::uint32_t> first_;
  std::vector<Edge> edges_;  // that are not in pairs
  std::vector<std::uint8_t> duplicate_;
  std::vector<FanFace> fan_;
  std::vector<Fin> fins_;
  FanPairing pairing_;
};

}  // namespace

void link_half_edges(const MeshView& mesh, const TopologyOptions& options, Topology& topology) {
  Linker(mesh, options, topology).run();
}

}  // namespace atlas
