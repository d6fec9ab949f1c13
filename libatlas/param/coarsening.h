// Internal: one step of algebraic multigrid's set-up, from the unknowns of one level to some seven
// times fewer.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/param/graph_laplacian.h"

namespace atlas::param {

// Rows of the prolongation from the next level, each of which sums to one.
template <class Real>
struct Prolongation {
  using Entry = typename GraphLaplacian<Real>::Entry;
  std::vector<std::uint32_t> first;
  std::vector<Entry> entries;

  std::span<const Entry> row(std::size_t i) const {
    return {entries.data() + first[i], entries.data() + first[i + 1]};
  }
};

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
  // From both halves of a, both halves of the next level's matrix; inverse_diagonal gets a's, 0
  // where it is not positive. False: it is not worth it (many vertices without strong neighbours,
  // or of huge valence).
  bool run(const GraphLaplacian<Real>& a, std::vector<Real>& inverse_diagonal,
           Prolongation<Real>& prolongation, GraphLaplacian<Real>& coarse);

 private:
  // Couplings of a group with those of smaller numbers, one after the other.
  struct Coupling {
    std::uint32_t column, next;
    double value;
  };

  void measure_diagonal(const GraphLaplacian<Real>& a, std::vector<Real>& inverse_diagonal);
  std::uint32_t aggregate(const GraphLaplacian<Real>& a);
  void prolongate(const GraphLaplacian<Real>& a, Prolongation<Real>& out);
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
