// Internal: finds paths across a piece of a flat chart along its edges.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/core/context.h"
#include "libatlas/core/counting_sort.h"
#include "libatlas/param/mesh/halfedges.h"

namespace atlas {

// Keeps its memory for the whole chart between calls.
class ChordPaths {
 public:
  // `piece_of` has one entry per triangle: the piece that it belongs to at the time of a call.
  // `polygons` as for LineCutter: paths do not lead through polygons. All arguments must outlive
  // the object.
  ChordPaths(const FlatChart& chart, const param::HalfEdges& half_edges,
             const std::vector<std::uint32_t>& piece_of, std::span<const std::uint32_t> polygons,
             const Context& context);

  struct Piece {
    std::span<const std::uint32_t> triangles, outline;  // outline: uvs
  };

  // Returns the edges inside the piece whose ends are both on its outline, as pairs of indices into
  // the outline, the lower one first.
  std::vector<std::array<std::uint32_t, 2>> edges_across(const Piece& piece);

  // Returns a path along edges of the piece from uv a to uv b, close to the straight line and with
  // no edge on the outline, as the half-edges on one side. Empty if there is no such path or the
  // context is cancelled. Dijkstra's algorithm.
  std::vector<std::uint32_t> find(const Piece& piece, std::uint32_t a, std::uint32_t b);

 private:
  // Returns the half-edge opposite to h, if it is in the same piece.
  std::uint32_t across(std::uint32_t h) const {
    const std::uint32_t o = half_edges_.opposite(h);
    return o != kNoIndex && piece_of_[o / 3] == piece_of_[h / 3] ? o : kNoIndex;
  }
  // Whether a path may follow h.
  bool open(std::uint32_t h) const {
    const std::uint32_t o = across(h);
    if (o == kNoIndex) return false;
    return polygons_.empty() ||
           polygons_[chart_.triangles[h / 3]] != polygons_[chart_.triangles[o / 3]];
  }
  // Fills by_. Returns the uvs that it reached.
  std::vector<std::uint32_t> search(std::uint32_t piece, std::uint32_t a, std::uint32_t b);
  // Returns the path from a to b, if by_ leads there and it is not much longer than the chord.
  std::vector<std::uint32_t> trace(std::uint32_t a, std::uint32_t b) const;

  const FlatChart& chart_;
  const param::HalfEdges& half_edges_;
  const std::vector<std::uint32_t>& piece_of_;
  std::span<const std::uint32_t> polygons_;
  const Context& context_;
  Buckets leaving_;                   // half-edges by the uv that they leave
  std::vector<std::uint32_t> by_;     // one per uv: the half-edge by which a path arrives
  std::vector<std::uint8_t> on_rim_;  // one per uv
};

}  // namespace atlas
