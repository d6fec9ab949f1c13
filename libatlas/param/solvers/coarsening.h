// Internal: one step of the set-up of algebraic multigrid, from the unknowns of one level to about
// seven times fewer.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/param/solvers/graph_laplacian.h"

namespace atlas::param {

// With more rows, memory is freed as soon as it is no longer needed: the temporary data of charts
// of some hundred thousand triangles would double their memory.
inline constexpr std::size_t large_system = 20000;

// Neighbourhoods of strongly coupled vertices become the unknowns of the next level, with a
// smoothed interpolation between them (Vanek, Mandel and Brezina 1996, "Algebraic multigrid by
// smoothed aggregation for second and fourth order elliptic problems"). The next level's matrix is
// not the product with that interpolation, which would take as long to compute as all cycles
// together, but the rescaled sum of the couplings between neighbourhoods (Braess 1995, "Towards
// algebraic multigrid for elliptic problems of second order"): this takes a tenth to a fifth more
// cycles, each of them shorter.
template <class Real>
class Coarsening {
 public:
  // Rows of the prolongation sum to one; inverse_diagonal is that of `a`, or 0 where that is not
  // positive. Of a large matrix only the lower half is kept, which is all that cycles need. Returns
  // false if coarsening is not worth it (many vertices without strong neighbours, or with very high
  // valence).
  bool run(GraphLaplacian<Real>& a, std::vector<Real>& inverse_diagonal,
           GraphRows<Real>& prolongation, GraphLaplacian<Real>& coarse);

 private:
  // A linked list of a group's couplings with groups of smaller numbers.
  struct Coupling {
    std::uint32_t column, next;
    double value;
  };

  void measure_diagonal(const GraphLaplacian<Real>& a, std::vector<Real>& inverse_diagonal);
  std::uint32_t aggregate(const GraphLaplacian<Real>& a);
  void prolongate(const GraphLaplacian<Real>& a, GraphRows<Real>& out);
  bool couple_groups(const GraphLaplacian<Real>& a);
  std::size_t couple(std::uint32_t row, std::uint32_t column, double value);
  void gather(GraphLaplacian<Real>& coarse) const;

  // One per row: a coupling is strong if it exceeds the product of both rows' strengths.
  std::vector<float> strength_;
  std::vector<std::uint32_t> group_, join_;
  std::uint32_t groups_ = 0;
  std::vector<std::uint32_t> place_;  // one per group: where it may be in the current row
  std::vector<std::uint32_t> size_;   // one per group: its number of rows
  std::vector<std::uint32_t> head_;   // one per group: its last coupling
  std::vector<Coupling> couplings_;
};

}  // namespace atlas::param
