// Internal: a stiffness matrix as a weighted graph. Its rows sum to zero, so the couplings of
// vertices are all of it: K x = sum over edges of a_ij (x_j - x_i), which holds the constants
// exactly in its kernel whatever the couplings are rounded to.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/param/halfedges.h"
#include "libatlas/param/stiffness.h"

namespace atlas::param {

template <class Real>
struct GraphLaplacian {
  struct Entry {
    std::uint32_t column;
    Real value;  // off the diagonal: negative between most neighbours
  };
  std::vector<std::uint32_t> first;  // 1 a row, and the end
  std::vector<Entry> entries;        // a pair of vertices may have several

  std::size_t rows() const { return first.size() - 1; }
  std::span<Entry> row(std::size_t i) {
    return {entries.data() + first[i], entries.data() + first[i + 1]};
  }
  std::span<const Entry> row(std::size_t i) const {
    return {entries.data() + first[i], entries.data() + first[i + 1]};
  }
  // Drops the entries right of the diagonal.
  void keep_lower();
};

// What the matrix of the elements has for the edge of each half-edge, 3 a triangle; a matrix entry
// is the sum of an edge's two. Returns the largest magnitude, weights left out.
template <class Real>
double edge_couplings(std::span<const Element> elements, const HalfEdges& half_edges,
                      std::vector<Real>& out);

// Both halves.
template <class Real>
void build_graph(std::span<const Real> couplings, const HalfEdges& half_edges, std::size_t vertices,
                 GraphLaplacian<Real>& out);

}  // namespace atlas::param
