#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <memory>
#include <vector>

#include "libatlas/param/solvers/linear_solver.h"

namespace atlas::param {

// Vertex 0 is held at 0 by leaving out its row and column.
struct SparseDirectSolver::Impl {
  Eigen::SparseMatrix<double> matrix;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor;
  std::vector<double> inverse_pivot;
  std::vector<glm::dvec2> work;
};

SparseDirectSolver::SparseDirectSolver() : impl_(std::make_unique<Impl>()) {}
SparseDirectSolver::~SparseDirectSolver() = default;

bool SparseDirectSolver::factorize(const SymmetricMatrix& matrix, bool same_pattern) {
  const int n = static_cast<int>(matrix.rows()) - 1;
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(static_cast<std::size_t>(n) + matrix.column.size() / 2);
  for (int i = 0; i < n; ++i) {
    triplets.emplace_back(i, i, matrix.diagonal[i + 1]);
    for (std::uint32_t k = matrix.first[i + 1]; k < matrix.first[i + 2]; ++k) {
      const int j = static_cast<int>(matrix.column[k]) - 1;
      if (j >= 0 && j < i) triplets.emplace_back(i, j, matrix.value[k]);
    }
  }
  impl_->matrix.resize(n, n);
  impl_->matrix.setFromTriplets(triplets.begin(), triplets.end());
  if (!same_pattern) impl_->factor.analyzePattern(impl_->matrix);
  // Rounding in the stiffness of slivers can exceed the stiffness that holds them. A slightly
  // larger diagonal makes the matrix definite again.
  for (const double lift : {0.0, 1e-13, 1e-10, 1e-7}) {
    if (lift > 0) {
      for (int i = 0; i < n; ++i) impl_->matrix.coeffRef(i, i) += lift * matrix.diagonal[i + 1];
    }
    impl_->factor.factorize(impl_->matrix);
    if (impl_->factor.info() != Eigen::Success) continue;
    const Eigen::VectorXd pivots = impl_->factor.vectorD();
    if (!(pivots.array() > 0).all()) continue;
    impl_->inverse_pivot.resize(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) impl_->inverse_pivot[i] = 1 / pivots[i];
    return true;
  }
  return false;
}

// Solves for both right-hand sides in one pass over the factor. Eigen's own solve reads it once for
// each.
void SparseDirectSolver::solve(std::span<const glm::dvec2> load, std::span<glm::dvec2> x) {
  const auto& lower = impl_->factor.matrixL().nestedExpression();  // by columns, without the
                                                                   // diagonal of ones
  const int n = static_cast<int>(lower.cols());
  const int *first = lower.outerIndexPtr(), *row = lower.innerIndexPtr();
  const double *value = lower.valuePtr(), *inverse_pivot = impl_->inverse_pivot.data();
  const int* place = impl_->factor.permutationP().indices().data();
  impl_->work.resize(static_cast<std::size_t>(n));
  glm::dvec2* work = impl_->work.data();
  for (int i = 0; i < n; ++i) work[place[i]] = load[i + 1];
  for (int j = 0; j < n; ++j) {
    const glm::dvec2 own = work[j];
    for (int k = first[j]; k < first[j + 1]; ++k) work[row[k]] -= value[k] * own;
  }
  for (int j = n; j-- > 0;) {
    glm::dvec2 sum = work[j] * inverse_pivot[j];
    for (int k = first[j]; k < first[j + 1]; ++k) sum -= value[k] * work[row[k]];
    work[j] = sum;
  }
  x[0] = glm::dvec2(0);
  for (int i = 0; i < n; ++i) x[i + 1] = work[place[i]];
}

}  // namespace atlas::param
