// Internal: draws borders apart that overlap a little.
#pragma once

#include <span>
#include <vector>

#include "libatlas/param/halfedges.h"
#include "libatlas/param/injectivity.h"
#include "libatlas/param/relax.h"

namespace atlas::param {

// Where two stretches of the border cross, each reaches into the other. Their vertices there are
// pulled a little more than half-way to the other side's border, the triangles around give way
// without flipping (Relaxer::pull), and so on until no border crosses. Overlaps deeper than a few
// dozen border vertices are left alone: those need a cut.
class Separator {
 public:
  // All triangles positive. Returns whether the map is injective afterwards; uvs are as they were
  // if not. half_edges: of the mesh.
  bool separate(const LocalMesh& mesh, std::span<const Element> elements,
                const CornerLists& corners, Relaxer& relaxer, std::span<Vec2d> uvs);

 private:
  struct Arc {  // what of one border reaches over the other
    std::vector<std::uint32_t> vertices, half_edges;
  };
  void map_border(const LocalMesh& mesh);
  bool collect(std::span<const BorderCrossing> crossings, std::span<const Vec2d> uvs);
  bool walk(std::uint32_t half_edge, std::uint32_t other, std::span<const Vec2d> uvs, Arc& out);
  void attract(const Arc& from, const Arc& to, std::span<const Vec2d> uvs);

  HalfEdges half_edges_;
  HalfEdges::Border border_;
  std::vector<std::uint32_t> next_, previous_;  // 1 a border vertex: the half-edge to and from it
  std::vector<std::uint8_t> crosses_;           // 1 a half-edge
  Arc arc_[2];
  std::vector<Relaxer::Spring> springs_;
  std::vector<double> distance_;      // 1 a vertex: of its spring
  std::vector<std::uint32_t> place_;  // 1 a vertex: 1 + its spring's place, or 0
  std::vector<Vec2d> saved_;
};

}  // namespace atlas::param
