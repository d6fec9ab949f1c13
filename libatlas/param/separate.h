// Internal: draws borders apart that overlap a little.
#pragma once

#include <span>
#include <unordered_map>
#include <vector>

#include "libatlas/param/halfedges.h"
#include "libatlas/param/injectivity.h"
#include "libatlas/param/relax.h"

namespace atlas::param {

// Where two stretches of the border cross, each reaches into the other. Their vertices there are
// drawn out of the other side's triangles, which give way without flipping (Relaxer::pull), and so
// on until no border crosses. Overlaps longer than a few dozen border vertices, more in fine
// charts, or deeper than a tenth of the chart's width are left alone: those need a cut.
class Separator {
 public:
  // All triangles positive. Returns whether the map is injective afterwards; uvs are as they were
  // if not.
  bool separate(const LocalMesh& mesh, ElementView elements, const CornerLists& corners,
                Relaxer& relaxer, std::span<Vec2d> uvs);

  // After that, if distortion around what moved is too high: lets it spread further.
  void settle_further(Relaxer& relaxer, std::span<Vec2d> uvs) { settle(relaxer, 0, uvs); }

  // Of the last call, if it failed: the crossings when they were fewest.
  std::span<const BorderCrossing> left() const { return left_; }

 private:
  struct Arc {                              // a stretch of border
    std::vector<std::uint32_t> half_edges;  // in order, from crossing to crossing
    std::vector<std::uint32_t> within;  // its vertices that may lie in the other side's triangles
    std::vector<std::uint32_t> beside;  // vertices a little beyond its ends
  };
  struct Depth {
    double outside;  // signed distance from the other side's triangles; negative: within them
    double margin;   // what it should be
    glm::dvec2 out;  // unit vector that leads there
  };
  enum Role : std::uint8_t { free_edge, crossing_edge, own_edge };
  struct Meeting {  // of one border half-edge with another
    std::uint32_t half_edge;
    double along;  // where on it, 0 to 1
    bool operator<(const Meeting& other) const {
      return half_edge != other.half_edge ? half_edge < other.half_edge : along < other.along;
    }
  };

  bool fine() const { return fineness_ > 1; }
  void map_border(const LocalMesh& mesh);
  bool collect(std::span<const BorderCrossing> crossings, std::span<const Vec2d> uvs);
  std::vector<double> loop_areas(std::span<const Vec2d> uvs) const;
  bool collect_turned_loops(std::span<const Vec2d> uvs);
  bool reach(std::uint32_t half_edge, std::uint32_t other, std::span<const Vec2d> uvs, Arc& out);
  double corner_angle(std::uint32_t vertex, std::span<const Vec2d> uvs) const;
  void keep_one_bank(Arc& arc, std::span<const Vec2d> uvs) const;
  void widen(Arc& arc, std::uint32_t first, std::uint32_t last) const;
  Depth depth(std::uint32_t vertex, bool may_be_within, int most_role,
              std::span<const Vec2d> uvs) const;
  void draw(std::uint32_t vertex, const Depth& depth, double share, std::span<const Vec2d> uvs);
  void mark(const Arc& arc, std::span<const BorderCrossing> crossings, bool set);
  void draw_out(const Arc& arc, double share, std::span<const Vec2d> uvs);
  bool collides(std::uint32_t half_edge) const;

  Injectivity check(std::span<const Vec2d> uvs) const;
  double longest() const;
  int rings(std::span<const Vec2d> uvs) const;
  void hold_moved();
  bool stalled();
  bool draw_until_simple(Relaxer& relaxer, std::span<Vec2d> uvs);
  void settle(Relaxer& relaxer, double least_gain, std::span<Vec2d> uvs);

  std::uint32_t next(std::uint32_t h) const { return next_[half_edges_.to(h)]; }
  std::uint32_t previous(std::uint32_t h) const { return previous_[half_edges_.from(h)]; }

  ElementView elements_;
  const CornerLists* corners_ = nullptr;
  HalfEdges half_edges_;
  HalfEdges::Border border_;
  std::vector<std::uint32_t> next_, previous_;  // 1 a border vertex: the half-edge from and to it
  std::vector<Meeting> meetings_;               // sorted
  std::vector<Arc> arcs_;                       // two a crossing, one after the other
  std::vector<std::uint32_t> candidates_;       // half-edges of all of them, sorted
  std::vector<std::uint8_t> role_;              // 1 a half-edge, for the stretch that is looked at
  bool across_ = false;                         // not by way of the edges that cross the stretch
  std::vector<Relaxer::Spring> springs_;
  double width_ = 0;                  // square root of what the triangles cover
  double fineness_ = 1;               // how many times as wide as fine_chart it is in edges, or 1
  bool deep_ = false;                 // the overlap, so that nothing was tried
  std::vector<double> pulled_;        // 1 a vertex: how far its spring reaches
  std::vector<double> pulls_;         // 1 a round: how far all springs reach together
  std::vector<std::uint32_t> place_;  // 1 a vertex: 1 + its spring's place, or 0
  std::vector<std::uint32_t> moved_;  // vertices that had a spring, each once
  std::unordered_map<std::uint32_t, Vec2d> targets_;  // of their last ones
  std::vector<Vec2d> saved_;
  std::vector<BorderCrossing> left_;
};

}  // namespace atlas::param
