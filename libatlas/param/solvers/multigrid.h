// Internal: conjugate gradients preconditioned by algebraic multigrid, for charts whose
// factorization would take longer.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/param/solvers/coarsening.h"
#include "libatlas/param/solvers/graph_laplacian.h"
#include "libatlas/param/solvers/linear_solver.h"

namespace atlas::param {

struct MultigridAccuracy {
  double energy;        // stop when the estimated energy of the error is at most this,
  double share;         // ... or at most this share of its initial value,
  int most_iterations;  // ... or after this many iterations
};

// Conjugate gradients, preconditioned by a V-cycle of symmetric Gauss-Seidel sweeps over the levels
// that Coarsening makes. Set-up and a step take O(n). The constants are in the matrix's kernel, so
// solutions are determined up to a translation. Of each large matrix only the lower half is kept.
// Corrections are iterated in Real; residuals between corrections are computed in double.
template <class Real>
class MultigridLevels {
 public:
  // Takes over the matrix. Returns false if the levels do not shrink.
  bool build(GraphLaplacian<Real>& matrix);
  // Improves x for the right-hand side `load`, and leaves the residual in `load`. Returns false if
  // x is not accurate enough after the iterations.
  bool solve(const MultigridAccuracy& accuracy, std::span<glm::dvec2> load, std::span<Vec2d> x);

 private:
  using Vector = std::vector<glm::vec<2, Real>>;
  struct Level {
    GraphLaplacian<Real> matrix;
    GraphRows<Real> prolongation;
    std::vector<Real> inverse_diagonal;
    Vector x, load;
    Vector rest;  // residual of a sweep; scratch
  };
  struct Progress {
    double goal;
    int steps_left;
    bool first = true;
  };
  enum class Outcome : std::uint8_t { done, failed, again };

  bool build_levels();
  void make_room();
  void factorize_coarsest();
  Outcome correct(const MultigridAccuracy& accuracy, double unit, Progress& progress);
  double step_direction(Real beta);
  void advance(Real alpha);
  void cycle(std::size_t level);
  void smooth_down(std::size_t level);
  void restrict_rest(std::size_t level);
  void smooth_up(std::size_t level);
  void solve_coarsest(Level& level);

  std::vector<Level> levels_;
  std::size_t depth_ = 0;  // levels above the coarsest one, which is solved directly
  Coarsening<Real> coarsening_;
  EnvelopeSolver coarsest_;
  Vector direction_, correction_;
  std::vector<glm::dvec2> coarse_load_, coarse_x_;
};

// Single precision halves the memory traffic. Double precision is used where rounded couplings
// would harm slivers.
class MultigridSolver {
 public:
  // Returns false if the levels do not shrink (many vertices without strong neighbours, or with
  // very high valence).
  bool build(const Elements& elements, const HalfEdges& half_edges, std::size_t vertices);
  bool solve(const MultigridAccuracy& accuracy, std::span<glm::dvec2> load, std::span<Vec2d> x);

 private:
  template <class Real>
  struct Precision {
    GraphLaplacian<Real> graph;
    MultigridLevels<Real> levels;
  };

  Precision<float> single_;
  Precision<double> twice_;
  bool exact_ = false;  // twice_ is in use
};

}  // namespace atlas::param
