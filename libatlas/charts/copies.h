// Internal: pieces of a mesh that repeat others, as the screws of an assembly do.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/charts/mesh/piece_list.h"
#include "libatlas/charts/mesh/topology.h"

namespace atlas {

struct PieceCopies {
  std::vector<std::uint32_t> original;  // 1 a piece: the piece that it repeats, or itself
  std::size_t copied_triangles = 0;     // of pieces that repeat another one
};

// A copy has its original's triangles in the same order, joined alike, with the same densities
// (`density`: 1 a triangle, or empty), and its edges and folds to 1e-5 of its size or to what
// coordinates so far from the origin can tell, whatever its place and turn; a mirrored part is no
// copy. Linear but for a sort of the pieces.
PieceCopies find_copies(const Topology& topology, std::span<const float> density);

// Carries charts from originals to copies. Both name triangles and vertices of the whole mesh.
class ChartCopier {
 public:
  ChartCopier(const FlattenInput& input, const PieceList& pieces);

  // The chart of piece `from` as piece `to` has it: the same uvs, its own cone and distortion.
  // False: that breaks a limit.
  bool copy(const FlatChart& chart, std::uint32_t from, std::uint32_t to, FlatChart& out) const;

 private:
  const FlattenInput& input_;
  const PieceList& pieces_;
};

}  // namespace atlas
