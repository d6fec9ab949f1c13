// Internal: solvers for the stiffness systems, for two right-hand sides (u and v) at once.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "libatlas/param/solvers/stiffness.h"

namespace atlas::param {

// Cholesky factorization within the envelope of the reordered matrix (reverse Cuthill-McKee). It
// takes O(n²) at worst for a disc of n vertices, and is faster than more elaborate methods up to
// some thousands. The kernel contains the constants, so one vertex of each connected piece gets the
// solution 0.
class EnvelopeSolver {
 public:
  void factorize(const SymmetricMatrix& matrix);
  // Orders the vertices of the elements. Returns the work of a factorization, in products of
  // blocks.
  double analyze(const Elements& elements, std::size_t vertices);
  // Factorizes the stiffness (as build_stiffness) of the elements analyzed last, whose weights may
  // differ.
  void factorize(const Elements& elements);
  // Overwrites x with the solution for the right-hand side `load`.
  void solve(std::span<const glm::dvec2> load, std::span<glm::dvec2> x);

 private:
  // The neighbours of each row; repeated ones do no harm.
  struct Graph {
    std::span<const std::uint32_t> first, column;
    std::size_t rows() const { return first.size() - 1; }
  };

  Graph connect(const Elements& elements, std::size_t vertices);
  void order(const Graph& graph);
  std::uint32_t sweep(const Graph& graph, std::uint32_t start);
  void find_envelope(const Graph& graph);
  void find_places(const Elements& elements);
  void fill(const SymmetricMatrix& matrix);
  void fill(const Elements& elements);
  void eliminate(std::span<const double> diagonal);
  std::size_t place(std::size_t i, std::size_t j) const;

  std::vector<std::uint32_t> order_, position_, queue_;
  std::vector<std::uint8_t> held_;  // one per vertex
  // The factor in blocks of 4 x 4: the blocks first_[b] .. b of block row b start at block row_[b].
  std::vector<std::uint32_t> first_;
  std::vector<std::size_t> row_;
  std::vector<double> factor_, inverse_pivot_;
  std::vector<glm::dvec2> work_;
  // For elements: their graph; where the entries of each element's sides, opposite to its corners,
  // are stored in the factor; the sums on the diagonal, one per vertex.
  std::vector<std::uint32_t> graph_first_, graph_column_;
  std::vector<std::array<std::size_t, 3>> places_;
  std::vector<double> diagonal_;
};

// Eigen's simplicial LDLT behind a pointer, so that its headers are included in one file only.
class SparseDirectSolver {
 public:
  SparseDirectSolver();
  ~SparseDirectSolver();
  // same_pattern: the entries are where they were in the last call, so its ordering is kept.
  // Returns false if the matrix is not definite to working precision.
  bool factorize(const SymmetricMatrix& matrix, bool same_pattern);
  void solve(std::span<const glm::dvec2> load, std::span<glm::dvec2> x);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace atlas::param
