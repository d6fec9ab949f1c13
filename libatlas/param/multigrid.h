// Internal: conjugate gradients preconditioned by algebraic multigrid, for charts whose
// factorisation would take longer.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/param/coarsening.h"
#include "libatlas/param/graph_laplacian.h"
#include "libatlas/param/linear_solver.h"

namespace atlas::param {

struct MultigridAccuracy {
  double energy;        // stop when the error's energy, estimated, is at most this,
  double share;         // ... or at most this part of what it was,
  int most_iterations;  // ... or after so many
};

// A V-cycle of symmetric Gauss-Seidel sweeps over the levels that Coarsening makes preconditions
// the iteration. Set-up and a step cost O(n). The constant vector is in the matrix's kernel, so
// solutions are determined up to a shift. Of each matrix the lower half is kept. A correction is
// iterated in Real; what is still to be corrected is found in double.
template <class Real>
class MultigridLevels {
 public:
  // Takes the matrix. False: the levels do not shrink.
  bool build(GraphLaplacian<Real>& matrix);
  // Improves x for the right-hand side `load`, and leaves in `load` what x lacks of it. False: not
  // accurate enough after the iterations.
  bool solve(const MultigridAccuracy& accuracy, std::span<glm::dvec2> load, std::span<Vec2d> x);

 private:
  using Vector = std::vector<glm::vec<2, Real>>;
  struct Level {
    GraphLaplacian<Real> matrix;
    GraphRows<Real> prolongation;
    std::vector<Real> inverse_diagonal;
    Vector x, load;
    Vector rest;  // what a sweep leaves; scratch
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
  std::size_t depth_ = 0;  // levels in use; the last one is solved directly
  Coarsening<Real> coarsening_;
  EnvelopeSolver coarsest_;
  Vector direction_, correction_;
  std::vector<glm::dvec2> coarse_load_, coarse_x_;
};

// Single precision halves what is moved through memory. Where slivers would suffer from rounded
// couplings, double precision is taken.
class MultigridSolver {
 public:
  // False: the levels do not shrink (many vertices without strong neighbours, or of huge valence).
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
