// Internal: ways across a piece of a flat chart along its edges.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/core/counting_sort.h"
#include "libatlas/param/halfedges.h"

namespace atlas {

// Keeps memory for the whole chart from call to call.
class ChordPaths {
 public:
  // 1 a triangle in `piece_of`: the piece that it belongs to, at the time of a call. All must
  // outlive the paths.
  ChordPaths(const FlatChart& chart, const param::HalfEdges& half_edges,
             const std::vector<std::uint32_t>& piece_of);

  struct Piece {
    std::span<const std::uint32_t> triangles, outline;  // outline: uvs
  };

  // Edges inside the piece whose ends are both in its outline: their places there, the lower first.
  std::vector<std::array<std::uint32_t, 2>> edges_across(const Piece& piece);

  // Edges of the piece from uv a to uv b, none of them along its outline, close to the straight
  // line: its half-edges on one side; empty if there is no such path. Dijkstra.
  std::vector<std::uint32_t> find(const Piece& piece, std::uint32_t a, std::uint32_t b);

 private:
  // The half-edge across h in the same piece.
  std::uint32_t across(std::uint32_t h) const {
    const std::uint32_t o = half_edges_.opposite(h);
    return o != kNoIndex && piece_of_[o / 3] == piece_of_[h / 3] ? o : kNoIndex;
  }
  // Fills by_; returns what it reached.
  std::vector<std::uint32_t> search(std::uint32_t piece, std::uint32_t a, std::uint32_t b);
  // From a to b, if by_ leads there and the way is not much longer than the chord.
  std::vector<std::uint32_t> trace(std::uint32_t a, std::uint32_t b) const;

  const FlatChart& chart_;
  const param::HalfEdges& half_edges_;
  const std::vector<std::uint32_t>& piece_of_;
  Buckets leaving_;                   // half-edges by the uv that they leave
  std::vector<std::uint32_t> by_;     // 1 a uv: the half-edge that a path comes by
  std::vector<std::uint8_t> on_rim_;  // 1 a uv
};

}  // namespace atlas
