#include "libatlas/unwrap/like/grow_charts.h"

#include <utility>

namespace atlas {
namespace {

class Grower {
 public:
  Grower(const JoinedMesh& mesh, TakenUvs& taken)
      : mesh_(mesh), taken_(taken), sets_(mesh.corners.size()), given_(mesh.corners.size()) {}

  GrownCharts run() {
    grown_.sense.assign(mesh_.triangle_count(), 0);
    for (std::uint32_t c = 0; c < given_.size(); ++c)
      given_[c] = taken_.chart[c / 3] == kNoIndex ? kNoIndex : c;
    std::vector<std::uint32_t> reached;
    for (std::uint32_t t = 0; t < grown_.sense.size(); ++t) {
      if (taken_.chart[t] == kNoIndex) continue;
      reached.push_back(t);
      grown_.sense[t] = twice_area(taken_.texels[t]) < 0 ? -1 : 1;
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t o = mesh_.across[h];
        if (o != kNoIndex && h < o && taken_.chart[o / 3] != kNoIndex) connect(h, o);
      }
    }
    for (std::size_t i = 0; i < reached.size(); ++i) {
      for (std::uint32_t k = 0; k < 3; ++k) grow(3 * reached[i] + k, reached);
    }
    grown_.uv.resize(given_.size());
    for (std::uint32_t c = 0; c < given_.size(); ++c) grown_.uv[c] = sets_.find(c);
    return std::move(grown_);
  }

 private:
  // Whether the two triangles run along their common edge in one direction.
  bool along(std::uint32_t h, std::uint32_t o) const {
    return mesh_.corners[h] == mesh_.corners[o];
  }
  // The corners of the triangle across that lie at the edge's first and second end.
  std::pair<std::uint32_t, std::uint32_t> ends(std::uint32_t h, std::uint32_t o) const {
    return along(h, o) ? std::pair(o, next_half_edge(o)) : std::pair(next_half_edge(o), o);
  }

  Vec2d given(std::uint32_t corner) const { return taken_.texels[corner / 3][corner % 3]; }

  bool agree(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t x = given_[sets_.find(a)], y = given_[sets_.find(b)];
    return x == kNoIndex || y == kNoIndex || given(x) == given(y);
  }
  void join(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t x = given_[sets_.find(a)], y = given_[sets_.find(b)];
    sets_.join(a, b);
    given_[sets_.find(a)] = x == kNoIndex ? y : x;
  }

  // Joins two triangles of charts, or makes their edge a seam.
  void connect(std::uint32_t h, std::uint32_t o) {
    const auto [first, second] = ends(h, o);
    const bool alike = taken_.chart[h / 3] == taken_.chart[o / 3] && !taken_.seams[h] &&
                       !taken_.seams[o] && agree(h, first) && agree(next_half_edge(h), second);
    if (!alike) {
      taken_.seams[h] = taken_.seams[o] = 1;
      return;
    }
    join(h, first);
    join(next_half_edge(h), second);
  }

  void grow(std::uint32_t h, std::vector<std::uint32_t>& reached) {
    const std::uint32_t o = mesh_.across[h];
    if (o == kNoIndex || taken_.seams[h]) return;
    const std::uint32_t t = h / 3, u = o / 3;
    if (taken_.chart[u] == kNoIndex) {
      taken_.chart[u] = taken_.chart[t];
      taken_.state[u] = TakenState::beside;
      grown_.sense[u] = std::int8_t(along(h, o) ? -grown_.sense[t] : grown_.sense[t]);
      reached.push_back(u);
    } else if (taken_.state[t] != TakenState::beside && taken_.state[u] != TakenState::beside) {
      return;  // connected before
    }
    connect(h, o);
  }

  const JoinedMesh& mesh_;
  TakenUvs& taken_;
  DisjointSets sets_;
  std::vector<std::uint32_t> given_;  // of a set, by its lowest corner: one with given texels
  GrownCharts grown_;
};

}  // namespace

GrownCharts grow_charts(const JoinedMesh& mesh, TakenUvs& taken) {
  return Grower(mesh, taken).run();
}

}  // namespace atlas
