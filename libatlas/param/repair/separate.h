// Internal: Separator, which removes small overlaps between parts of a border.
#pragma once

#include <span>
#include <unordered_map>
#include <vector>

#include "libatlas/param/injectivity.h"
#include "libatlas/param/mesh/halfedges.h"
#include "libatlas/param/relaxing/relax.h"

namespace atlas::param {

// Where the border crosses itself, an arc on each side reaches into the triangles of the other.
// Springs pull the vertices there out of the other side's triangles, which give way without
// flipping (Relaxer::pull), and this is repeated until the border does not cross itself. Overlaps
// that are longer than a few dozen border vertices (more in fine charts), or deeper than a tenth of
// the chart's width, are left alone: they need a cut.
class Separator {
 public:
  // Sets the chart. The mesh, its elements and its corner lists must outlive the calls below.
  void take(const LocalMesh& mesh, ElementView elements, const CornerLists& corners);

  // Removes overlaps; all triangles must be positive. Returns whether the map is injective
  // afterwards. If not, uvs are unchanged.
  bool separate(Relaxer& relaxer, std::span<Vec2d> uvs);

  // To be called after that, if distortion around the moved vertices is too high: lets it spread
  // further.
  void settle_further(Relaxer& relaxer, std::span<Vec2d> uvs) { settle(relaxer, 0, uvs); }

  // If the last call failed: the crossings of the round with the fewest.
  std::span<const BorderCrossing> left() const { return left_; }

 private:
  struct Arc {                              // a part of the border between crossings
    std::vector<std::uint32_t> half_edges;  // in order, from crossing to crossing
    // Its vertices that may lie in the other side's triangles.
    std::vector<std::uint32_t> within;
    std::vector<std::uint32_t> beside;  // vertices a little beyond its ends
  };
  struct Depth {
    double outside;  // signed distance from the other side's triangles; negative: inside
    double margin;   // the distance that is needed
    glm::dvec2 out;  // unit vector that leads there
  };
  enum Role : std::uint8_t { free_edge, crossing_edge, own_edge };
  struct Meeting {  // the point where one border half-edge meets another
    std::uint32_t half_edge;
    double along;  // position on it, 0 to 1
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
  // One per border vertex: the half-edge from it, and the one to it.
  std::vector<std::uint32_t> next_, previous_;
  std::vector<Meeting> meetings_;          // sorted
  std::vector<Arc> arcs_;                  // two per crossing, one after the other
  std::vector<std::uint32_t> candidates_;  // half-edges of all arcs, sorted
  std::vector<std::uint8_t> role_;         // one per half-edge, for the current arc
  bool across_ = false;  // the second way, which excludes edges that cross the arc
  std::vector<Relaxer::Spring> springs_;
  double width_ = 0;                  // square root of the area of all triangles
  double fineness_ = 1;               // width in edges, relative to that of fine_chart, or 1
  bool deep_ = false;                 // the overlap is too deep, so nothing was tried
  std::vector<double> pulled_;        // one per vertex: the length of its spring
  std::vector<double> pulls_;         // one per round: the total length of all springs
  std::vector<std::uint32_t> place_;  // one per vertex: 1 + its spring's index, or 0
  std::vector<std::uint32_t> moved_;  // vertices that had a spring, each once
  std::unordered_map<std::uint32_t, Vec2d> targets_;  // of their last springs
  std::vector<Vec2d> saved_;
  std::vector<BorderCrossing> left_;
};

}  // namespace atlas::param
