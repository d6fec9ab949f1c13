// Internal: a stiffness matrix as a weighted graph. Its rows sum to zero, so the couplings of
// vertices are all of it: K x = sum over edges of a_ij (x_j - x_i), which holds the constants
// exactly in its kernel whatever the couplings are rounded to.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/param/halfedges.h"
#include "libatlas/param/stiffness.h"

namespace atlas::param {

template <class Real>
struct GraphEntry {
  std::uint32_t column;
  Real value;
};

template <class Real>
struct GraphRows {
  std::vector<std::uint32_t> first;  // 1 a row, and the end
  std::vector<GraphEntry<Real>> entries;

  std::size_t rows() const { return first.size() - 1; }
  std::span<const GraphEntry<Real>> row(std::size_t i) const {
    return {entries.data() + first[i], entries.data() + first[i + 1]};
  }
};

// The entries off the diagonal, negative between most neighbours; a pair of vertices may have
// several. Those below the diagonal and those above it apart: only a set-up needs both.
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

// Makes the two from edges: each(body) calls body(a, b, value) once for every edge, the same each
// time.
template <class Real, class Each>
void gather_edges(std::size_t vertices, const Each& each, GraphLaplacian<Real>& out) {
  // first[v + 1] counts, then moves from the beginning of v's row to its end.
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

// What the matrix of the elements has for the edge of each half-edge, 3 a triangle; a matrix entry
// is the sum of an edge's two. Returns the largest magnitude, weights left out.
template <class Real>
double edge_couplings(const Elements& elements, const HalfEdges& half_edges,
                      std::vector<Real>& out);

template <class Real>
void build_graph(std::span<const Real> couplings, const HalfEdges& half_edges, std::size_t vertices,
                 GraphLaplacian<Real>& out);

}  // namespace atlas::param
