#include "libatlas/charts/mesh/links.h"

#include <algorithm>
#include <vector>

#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

// Of several triangles at an edge, two are linked as neighbours only if they fold by less than 60
// degrees.
constexpr double kFlatPair = 0.5;
// Larger fans around one edge are left open, since pairing takes quadratic time.
constexpr std::size_t kMaxPairedFan = 32;

glm::dvec3 point(const Topology& topology, std::uint32_t corner) {
  return to_dvec(topology.points[topology.corner_vertex[corner]]);
}

// Links half-edges that share an edge.
class Linker {
 public:
  Linker(const MeshView& mesh, const TopologyOptions& options, Topology& topology)
      : mesh_(mesh), options_(options), topology_(topology) {}

  void run() {
    sort_by_lower_vertex();
    topology_.opposite.assign(topology_.corner_vertex.size(), kNoIndex);
    duplicate_.assign(topology_.triangle_count(), 0);
    // The data for linking a half-edge may lie anywhere in memory. It is prefetched this many
    // half-edges ahead.
    constexpr std::size_t ahead = 64;
    std::size_t asked = 0;
    for (std::size_t v = 0; v + 1 < first_.size(); ++v) {
      for (; asked < std::min(edges_.size(), first_[v + 1] + ahead); ++asked) {
        __builtin_prefetch(topology_.corner_vertex.data() + edges_[asked].half_edge);
        __builtin_prefetch(topology_.opposite.data() + edges_[asked].half_edge, 1);
      }
      link_bucket(edges_.data() + first_[v], edges_.data() + first_[v + 1]);
    }
  }

  bool needs_turning() const { return topology_.defects.misoriented_edges > 0; }

 private:
  struct Edge {
    std::uint32_t upper, half_edge;
  };

  std::uint32_t from(std::uint32_t h) const { return topology_.corner_vertex[h]; }
  std::uint32_t to(std::uint32_t h) const { return topology_.corner_vertex[next_half_edge(h)]; }
  std::uint32_t third(std::uint32_t h) const {
    return topology_.corner_vertex[previous_half_edge(h)];
  }

  void sort_by_lower_vertex() {
    const auto n = static_cast<std::uint32_t>(topology_.corner_vertex.size());
    first_.assign(topology_.points.size() + 2, 0);
    const auto each = [&](auto&& body) {
      for (std::uint32_t t = 0; t < n / 3; ++t) {
        if (topology_.degenerate(t)) continue;
        for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
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
      std::sort(begin, end, order);
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
      mark_duplicate(g, h);
      topology_.cut_length += length(g);
    } else if (!may_link(g, h)) {
      topology_.cut_length += length(g);
    } else {
      link(g, h);
    }
  }

  void link_fan(const Edge* begin, const Edge* end) {
    ++topology_.defects.nonmanifold_edges;
    std::vector<std::uint32_t> fan;
    for (const Edge* e = begin; e < end; ++e) fan.push_back(e->half_edge);
    std::sort(fan.begin(), fan.end(), [&](std::uint32_t g, std::uint32_t h) {
      return third(g) != third(h) ? third(g) < third(h) : g < h;
    });
    // The first layer holds the first triangle with each third vertex, the second layer the first
    // duplicates of these, and so on. There are as many layers as the surface has coincident copies
    // here.
    std::vector<std::vector<std::uint32_t>> layers;
    for (std::size_t i = 0, layer = 0; i < fan.size(); ++i) {
      const bool copy = i > 0 && third(fan[i]) == third(fan[i - 1]);
      if (copy) mark_duplicate(fan[i - 1], fan[i]);
      layer = copy ? layer + 1 : 0;
      if (layer == layers.size()) layers.emplace_back();
      layers[layer].push_back(fan[i]);
    }
    for (const std::vector<std::uint32_t>& layer : layers) pair_by_flatness(layer);
  }

  void pair_by_flatness(const std::vector<std::uint32_t>& fan) {
    if (fan.size() < 2 || fan.size() > kMaxPairedFan) return;
    struct Pair {
      double flatness;
      std::uint32_t g, h;
    };
    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < fan.size(); ++i) {
      for (std::size_t j = i + 1; j < fan.size(); ++j) {
        const double flatness = -glm::dot(wing(fan[i]), wing(fan[j]));
        if (flatness > kFlatPair && may_link(fan[i], fan[j])) {
          pairs.push_back({flatness, std::min(fan[i], fan[j]), std::max(fan[i], fan[j])});
        }
      }
    }
    std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
      if (a.flatness != b.flatness) return a.flatness > b.flatness;
      return a.g != b.g ? a.g < b.g : a.h < b.h;
    });
    for (const Pair& pair : pairs) {
      if (topology_.opposite[pair.g] == kNoIndex && topology_.opposite[pair.h] == kNoIndex) {
        link(pair.g, pair.h);
        topology_.fan_links.push_back(pair.g);
      }
    }
  }

  // Returns the unit direction, perpendicular to the edge, in which the triangle of h lies.
  glm::dvec3 wing(std::uint32_t h) const {
    const std::uint32_t low = from(h) < to(h) ? h : next_half_edge(h);
    const std::uint32_t high = from(h) < to(h) ? next_half_edge(h) : h;
    const glm::dvec3 a = point(topology_, low), edge = glm::normalize(point(topology_, high) - a);
    const glm::dvec3 d = point(topology_, previous_half_edge(h)) - a;
    return glm::normalize(d - glm::dot(d, edge) * edge);
  }

  bool may_link(std::uint32_t g, std::uint32_t h) const {
    const std::uint32_t s = g / 3, t = h / 3;
    if (options_.cut_at_materials && !mesh_.materials.empty() &&
        mesh_.materials[s] != mesh_.materials[t]) {
      return false;
    }
    if (!options_.cut_at_uv_seams || mesh_.texcoord_indices.empty()) return true;
    const bool aligned = from(g) == from(h);
    return same_texcoord(g, aligned ? h : next_half_edge(h)) &&
           same_texcoord(next_half_edge(g), aligned ? next_half_edge(h) : h);
  }

  bool same_texcoord(std::uint32_t i, std::uint32_t j) const {
    const std::uint32_t a = mesh_.texcoord_indices[i], b = mesh_.texcoord_indices[j];
    if (a == b) return true;
    const std::size_t n = mesh_.texcoords.size();
    return a < n && b < n && mesh_.texcoords[a] == mesh_.texcoords[b];
  }

  double length(std::uint32_t h) const {
    return glm::distance(point(topology_, h), point(topology_, next_half_edge(h))) /
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
  std::vector<Edge> edges_;
  std::vector<std::uint8_t> duplicate_;
};

}  // namespace

void link_half_edges(const MeshView& mesh, const TopologyOptions& options, Topology& topology) {
  Linker(mesh, options, topology).run();
}

}  // namespace atlas
