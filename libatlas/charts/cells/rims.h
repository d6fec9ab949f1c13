// Internal: the borders of cells as loops of half-edges.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/cells/cells.h"
#include "libatlas/charts/mesh/topology.h"

namespace atlas {

struct RimLoop {
  std::uint32_t begin, end;  // range of Rims::path
  double length;
  bool open;  // all of it on the mesh's border
};

class Rims {
 public:
  // Linear in the number of triangles. Both must outlive this.
  Rims(const Topology& topology, const Cells& cells);

  bool on_rim(std::uint32_t h) const { return cell(h) != kNoIndex && across(h) != cell(h); }
  // The loops of one cell, over `path`.
  std::span<const RimLoop> loops(std::uint32_t k) const {
    return {loops_.data() + first_loop_[k], first_loop_[k + 1] - first_loop_[k]};
  }
  // Of all cells, by cell and id.
  const std::vector<std::uint32_t>& half_edges() const { return rim_; }

  std::vector<std::uint32_t> path;

 private:
  std::uint32_t cell(std::uint32_t h) const { return cells_.of_triangle[h / 3]; }
  std::uint32_t across(std::uint32_t h) const {
    const std::uint32_t o = topology_.opposite[h];
    return o == kNoIndex ? kNoIndex : cell(o);
  }
  void sort_by_cell();
  void walk(std::uint32_t start);

  const Topology& topology_;
  const Cells& cells_;
  std::vector<std::uint32_t> first_, rim_;
  std::vector<std::uint8_t> seen_;
  std::vector<RimLoop> loops_;
  std::vector<std::uint32_t> first_loop_;  // 1 a cell and the end
};

// The place of the longest loop; of nearly equal ones the first. Precondition: not empty.
std::size_t longest_loop(std::span<const RimLoop> loops);

// Triangles with two edges on one other cell join it, one after the other, as long as there are
// any: where two fronts came by at about the same time, rounding would decide, and whether one
// triangle is in a cell or not can change what is merged later. Cells stay connected, and none
// loses its last triangle. Ends: every move shortens the rims by an edge at least.
// None crosses what bounds a face, if `faces` is not null.
void pull_teeth(const Topology& topology, const Faces* faces, Cells& cells);

// Divides cells in two, again and again, until the border of each is one loop but for small holes
// of the mesh. Returns the rims.
Rims divide_rings(const Topology& topology, Cells& cells);

}  // namespace atlas
