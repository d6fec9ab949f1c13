// Internal: pairs the triangles around an edge that more than two of them share, so that sheets
// that touch, cross or lie upon each other there stay whole.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

namespace atlas {

// One of the triangles around an edge.
struct FanFace {
  std::uint32_t half_edge = 0;
  std::uint32_t third = 0;  // the vertex off the edge, so coincident triangles have the same
  bool forward = true;      // whether the half-edge runs from the lower to the higher vertex
  glm::dvec3 wing{};        // unit direction, perpendicular to the edge, in which the triangle lies
  glm::dvec3 normal{};      // unit length
  std::uint32_t layer = 0;  // filled by the pairing
};

// Chooses pairs of triangles that continue each other. The choice follows from the shape and the
// orientation of the triangles. The order of vertices decides between pairings that are equally
// good, and the order of triangles only between coincident ones of equal orientation.
class FanPairing {
 public:
  using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

  // Returns pairs of half-edges. The triangles must come in the order of `third`, then of
  // half-edges, and are sorted by layers. may_link(g, h) says whether these two may be paired at
  // all. The result is valid until the next call.
  template <class MayLink>
  const Pairs& run(std::vector<FanFace>& faces, const MayLink& may_link) {
    pairs_.clear();
    sort_into_layers(faces);
    single_.clear();
    for (std::size_t i = 0, j = 0; i < faces.size(); i = j) {
      members_.clear();
      for (; j < faces.size() && faces[j].layer == faces[i].layer; ++j) members_.push_back(j);
      pair_members(faces, may_link);
    }
    members_.swap(single_);
    single_.clear();
    pair_members(faces, may_link);
    return pairs_;
  }

 private:
  static constexpr double kNever = 100;  // the cost of what may not be a pair
  // Larger layers are left open, since each exchange takes cubic time.
  static constexpr std::size_t kMaxFaces = 32;

  static void sort_into_layers(std::vector<FanFace>& faces);
  // Of members of equal orientation, one must be turned if they are a pair. Returns what it costs.
  double turned_cost(const std::vector<FanFace>& faces) const;
  static double cost(const FanFace& a, const FanFace& b, double turned);

  // Pairs the members. Those that stay alone are added to single_.
  template <class MayLink>
  void pair_members(const std::vector<FanFace>& faces, const MayLink& may_link) {
    const std::size_t n = members_.size() <= kMaxFaces ? members_.size() : 0;
    const double turned = turned_cost(faces);
    costs_.assign(n * n, kNever);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = i + 1; j < n; ++j) {
        const FanFace &a = faces[members_[i]], &b = faces[members_[j]];
        if (a.third == b.third || !may_link(a.half_edge, b.half_edge)) continue;
        costs_[i * n + j] = costs_[j * n + i] = cost(a, b, turned);
      }
    }
    mates_.resize(n);
    for (std::size_t i = 0; i < n; ++i) mates_[i] = i;
    while (exchange()) {
    }
    for (std::size_t i = 0; i < members_.size(); ++i) {
      const std::size_t mate = i < n ? mates_[i] : i;
      if (mate == i) single_.push_back(members_[i]);
      if (mate <= i) continue;
      pairs_.emplace_back(faces[members_[i]].half_edge, faces[members_[mate]].half_edge);
    }
  }

  // Makes (i, j) a pair, and (left, partner) if there is such a partner.
  struct Exchange {
    std::size_t i, j, left, partner;
    double saving;
  };

  void consider(std::size_t i, std::size_t j, Exchange& best) const;
  bool exchange();
  double cost_of(std::size_t i, std::size_t j) const;

  Pairs pairs_;
  std::vector<std::size_t> members_, single_;  // indices of triangles
  std::vector<double> costs_;                  // of pairs of members, in rows
  std::vector<std::size_t> mates_;             // one per member: its partner, or itself if alone
};

}  // namespace atlas
