// Internal: a stiffness matrix as a weighted graph. Its rows sum to zero, so the couplings of
// vertices determine it: K x = sum over edges of a_ij (x_j - x_i). Constants are exactly in its
// kernel, however the couplings are rounded.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/param/mesh/halfedges.h"
#include "libatlas/param/solvers/stiffness.h"

namespace atlas::param {

template <class Real>
struct GraphEntry {
  std::uint32_t column;
  Real value;
};

template <class Real>
struct GraphRows {
  std::vector<std::uint32_t> first;  // one per row, and the end
  std::vector<GraphEntry<Real>> entries;

  std::size_t rows() const { return first.size() - 1; }
  std::span<const GraphEntry<Real>> row(std::size_t i) const {
    return {entries.data() + first[i], entries.data() + first[i + 1]};
  }
};

// The entries off the diagonal, which are negative between most neighbours. A pair of vertices may
// have several. Entries below and above the diagonal are stored separately, since only a set-up
// needs both.
template <class Real>
struct GraphLaplacian {
  GraphRows<Real> lower, upper;

  std::size_t rows() const { return lower.rows(); }
  template <class Body>
  void each_of_row(std::size_t i, const Body& body) const {
    for (const auto& entry : lower.row(i)) body(entry);
    for (const auto& entry : upper.row(i)) body(entry);
  }
};

// Builds both halves from edges. each(body) must call body(a, b, value) once for every edge, in the
// same order each time.
template <class Real, class Each>
void gather_edges(std::size_t vertices, const Each& each, GraphLaplacian<Real>& out) {
  // first[v + 1] first counts, then moves from the beginning of v's row to its end.
  for (GraphRows<Real>* half : {&out.lower, &out.upper}) half->first.assign(vertices + 2, 0);
  std::uint32_t *lower = out.lower.first.data(), *upper = out.upper.first.data();
  each([&](std::uint32_t a, std::uint32_t b, Real) {
    ++lower[std::max(a, b) + 2];
    ++upper[std::min(a, b) + 2];
  });
  for (GraphRows<Real>* half : {&out.lower, &out.upper}) {
    for (std::size_t v = 2; v < vertices + 2; ++v) half->first[v] += half->first[v - 1];
    half->entries.resize(half->first.back());
  }
  each([&](std::uint32_t a, std::uint32_t b, Real value) {
    const std::uint32_t low = std::min(a, b), high = std::max(a, b);
    out.lower.entries[lower[high + 1]++] = {low, value};
    out.upper.entries[upper[low + 1]++] = {high, value};
  });
  out.lower.first.pop_back();
  out.upper.first.pop_back();
}

// Computes the contribution of each half-edge to the matrix entry of its edge, three per triangle;
// an entry is the sum of an edge's two. Returns the largest magnitude, without weights.
template <class Real>
double edge_couplings(const Elements& elements, const HalfEdges& half_edges,
                      std::vector<Real>& out);

template <class Real>
void build_graph(std::span<const Real> couplings, const HalfEdges& half_edges, std::size_t vertices,
                 GraphLaplacian<Real>& out);

}  // namespace atlas::param
