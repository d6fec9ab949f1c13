// Internal: conjugate gradients preconditioned by algebraic multigrid, for charts whose
// factorisation would take longer.
#pragma once

#include <span>
#include <vector>

#include "libatlas/param/linear_solver.h"
#include "libatlas/param/stiffness.h"

namespace atlas::param {

// Smoothed aggregation (Vanek, Mandel and Brezina 1996, "Algebraic multigrid by smoothed
// aggregation for second and fourth order elliptic problems"): neighbourhoods of strongly joined
// vertices become the unknowns of the next level, some seven times fewer; a V-cycle of symmetric
// Gauss-Seidel sweeps preconditions the iteration. Set-up and a step cost O(n). The constant vector
// is in the matrix's kernel, so solutions are determined up to a shift. The cycle works in single
// precision, which halves what it moves through memory; the iteration around it, in double, decides
// how exact the solution is.
class MultigridSolver {
 public:
  // False: the levels do not shrink (many vertices without strong neighbours, or of huge valence).
  bool build(const SymmetricMatrix& matrix);

  struct Accuracy {
    double energy;        // stop when the error's energy, estimated, is at most this,
    double share;         // ... or at most this part of what it was,
    int most_iterations;  // ... or after so many
  };
  // Improves x for the right-hand side `load`. False: not accurate enough after the iterations.
  bool solve(const SymmetricMatrix& matrix, std::span<const glm::dvec2> load,
             const Accuracy& accuracy, std::span<glm::dvec2> x);

 private:
  struct Entry {
    std::uint32_t column;
    float value;
  };
  struct Level {
    // Empty on the finest: that one is the caller's. Once the levels stand, only the rows' ends and
    // the diagonal are left of the others.
    SymmetricMatrix matrix;
    // What the cycle reads: rows of the matrix as in `matrix`, of the prolongation, and the
    // latter's ends.
    std::vector<std::uint32_t> first;
    std::vector<Entry> entries, prolongation;
    std::vector<float> inverse_diagonal;
    std::vector<glm::vec2> x, load;
  };

  // Of one level while the next one is made; kept for the memory alone.
  struct Setup {
    std::vector<std::uint32_t> aggregate;
    // The prolongation by rows (whose ends the level keeps), and the same by columns.
    std::vector<std::uint32_t> column, column_first, row;
    std::vector<double> value, column_value;
    // The matrix times the prolongation, by rows.
    std::vector<std::uint32_t> product_first, product_column;
    std::vector<double> product_value;
  };

  std::uint32_t aggregate(const SymmetricMatrix& matrix, Level& level);
  void prolongate(const SymmetricMatrix& matrix, std::uint32_t coarse, Level& level);
  void transpose(std::uint32_t coarse, const Level& level);
  void store_single(const SymmetricMatrix& matrix, Level& level) const;
  bool multiply_prolongation(const SymmetricMatrix& matrix, std::uint32_t coarse,
                             const Level& level);
  bool coarsen(std::size_t most_entries, SymmetricMatrix& out) const;
  bool build_levels(const SymmetricMatrix& matrix);
  void cycle(const SymmetricMatrix& finest, std::size_t level);
  void smooth_down(const SymmetricMatrix& matrix, std::size_t level);
  void smooth_up(const SymmetricMatrix& matrix, std::size_t level);
  void solve_coarsest(Level& level);

  std::vector<Level> levels_;
  std::size_t depth_ = 0;  // levels in use; the last one is solved directly
  Setup setup_;
  EnvelopeSolver coarsest_;
  std::vector<glm::dvec2> direction_, product_, residual_, coarse_load_, coarse_x_;
};

}  // namespace atlas::param
