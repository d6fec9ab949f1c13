// Internal: one step of algebraic multigrid's set-up, from the unknowns of one level to some seven
// times fewer.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/param/graph_laplacian.h"

namespace atlas::param {

// Rows above which memory is given back as soon as it is needed no more: what charts of some
// hundred thousand triangles need for a moment would double what they need.
inline constexpr std::size_t large_system = 20000;

// Neighbourhoods of strongly joined vertices become the unknowns of the next level; interpolation
// between them is smoothed (Vanek, Mandel and Brezina 1996, "Algebraic multigrid by smoothed
// aggregation for second and fourth order elliptic problems"). The next level's matrix is not the
// product with that interpolation, which would take as long to make as all cycles together, but
// the sum of the couplings between neighbourhoods, rescaled (Braess 1995, "Towards algebraic
// multigrid for elliptic problems of second order"): a tenth to a fifth more cycles, each of them
// shorter.
template <class Real>
class Coarsening {
 public:
  // The prolongation has rows of sum one; inverse_diagonal is a's, 0 where it is not positive.
  // Of a large matrix the lower half is left, which is all that cycles need. False: it is not worth
  // it (many vertices without strong neighbours, or of huge valence).
  bool run(GraphLaplacian<Real>& a, std::vector<Real>& inverse_diagonal,
           GraphRows<Real>& prolongation, GraphLaplacian<Real>& coarse);

 private:
  // Couplings of a group with those of smaller numbers, one after the other.
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

  std::vector<float> strength_;  // 1 a row: what a coupling must exceed, together with the other's
  std::vector<std::uint32_t> group_, join_;
  std::uint32_t groups_ = 0;
  std::vector<std::uint32_t> place_;  // 1 a group: where it may stand in the row at hand
  std::vector<std::uint32_t> size_;   // 1 a group: its rows
  std::vector<std::uint32_t> head_;   // 1 a group: its last coupling
  std::vector<Coupling> couplings_;
};

}  // namespace atlas::param
