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
  bool open;  // the whole loop lies on the mesh's boundary
};

class Rims {
 public:
  // Linear in the number of triangles. Both arguments must outlive the object.
  Rims(const Topology& topology, const Cells& cells);

  bool on_rim(std::uint32_t h) const { return cell(h) != kNoIndex && across(h) != cell(h); }
  // The loops of one cell, over `path`.
  std::span<const RimLoop> loops(std::uint32_t k) const {
    return {loops_.data() + first_loop_[k], first_loop_[k + 1] - first_loop_[k]};
  }
  // The border half-edges of all cells, sorted by cell and id.
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
  std::vector<std::uint32_t> first_loop_;  // one per cell, and the end
};

// Returns the index of the longest loop, the first one among nearly equal ones. Precondition: not
// empty.
std::size_t longest_loop(std::span<const RimLoop> loops);

// Moves each triangle with two or three edges on one other cell to that cell, until none is left.
// Where two fronts arrive at about the same time, rounding would otherwise decide, and a single
// triangle can change what is merged later. Cells stay connected, and none loses its last triangle.
// The loop ends because every move shortens the borders by at least one edge. If
// `regions` is not null, no triangle crosses the border of one.
void pull_teeth(const Topology& topology, const Regions* regions, Cells& cells);

// Divides cells in two, repeatedly, until the border of each is one loop, apart from small holes of
// the mesh. Returns the borders.
Rims divide_rings(const Topology& topology, Cells& cells);

}  // namespace atlas
