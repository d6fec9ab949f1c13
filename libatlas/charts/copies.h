// Internal: finds pieces of a mesh that repeat others, as the screws of an assembly do.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/charts/mesh/piece_list.h"
#include "libatlas/charts/mesh/topology.h"

namespace atlas {

struct PieceCopies {
  std::vector<std::uint32_t> original;  // one per piece: the piece that it repeats, or itself
  std::size_t copied_triangles = 0;     // triangles of pieces that repeat another one
};

// Finds the pieces that repeat others, in time linear except for a sort of the pieces. A copy has
// its original's triangles in the same order, with the same links and the same densities
// (`density`: one per triangle, or empty). Its edges and folds agree to 1e-5 of its size, or to the
// precision of coordinates that far from the origin. Position and rotation do not matter; a
// mirrored part is not a copy.
PieceCopies find_copies(const Topology& topology, std::span<const float> density);

// Copies charts from originals to copies. Charts refer to triangles and vertices of the whole mesh.
class ChartCopier {
 public:
  ChartCopier(const FlattenInput& input, const PieceList& pieces);

  // Makes `out` the counterpart in piece `to` of a chart of piece `from`: with the same uvs, but
  // its own cone and distortion. Returns false if these exceed a limit.
  bool copy(const FlatChart& chart, std::uint32_t from, std::uint32_t to, FlatChart& out) const;

 private:
  const FlattenInput& input_;
  const PieceList& pieces_;
};

}  // namespace atlas
