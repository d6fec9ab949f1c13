#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <memory>

#include "libatlas/param/linear_solver.h"

namespace atlas::param {

// Vertex 0 is held at 0 by leaving its row and column out.
struct SparseDirectSolver::Impl {
  Eigen::SparseMatrix<double> matrix;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor;
  Eigen::Matrix<double, Eigen::Dynamic, 2> load, solution;
};

SparseDirectSolver::SparseDirectSolver() : impl_(std::make_unique<Impl>()) {}
SparseDirectSolver::~SparseDirectSolver() = default;

bool SparseDirectSolver::factorize(const SymmetricMatrix& matrix, bool same_pattern) {
  const int n = static_cast<int>(matrix.rows()) - 1;
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(static_cast<std::size_t>(n) + matrix.column.size() / 2);
  for (int i = 0; i < n; ++i) {
    triplets.emplace_back(i, i, matrix.diagonal[i + 1]);
    for (std::uint32_t k = matrix.first[i + 1]; k < matrix.middle[i + 1]; ++k) {
      const int j = static_cast<int>(matrix.column[k]) - 1;
      if (j >= 0) triplets.emplace_back(i, j, matrix.value[k]);
    }
  }
  impl_->matrix.resize(n, n);
  impl_->matrix.setFromTriplets(triplets.begin(), triplets.end());
  if (!same_pattern) impl_->factor.analyzePattern(impl_->matrix);
  // Slivers' stiffness can drown what holds them in rounding; a slightly larger diagonal restores
  // it.
  for (const double lift : {0.0, 1e-13, 1e-10, 1e-7}) {
    if (lift > 0) {
      for (int i = 0; i < n; ++i) impl_->matrix.coeffRef(i, i) += lift * matrix.diagonal[i + 1];
    }
    impl_->factor.factorize(impl_->matrix);
    if (impl_->factor.info() == Eigen::Success && (impl_->factor.vectorD().array() > 0).all()) {
      return true;
    }
  }
  return false;
}

void SparseDirectSolver::solve(std::span<const glm::dvec2> load, std::span<glm::dvec2> x) {
  const Eigen::Index n = impl_->matrix.rows();
  impl_->load.resize(n, 2);
  for (Eigen::Index i = 0; i < n; ++i) impl_->load.row(i) << load[i + 1].x, load[i + 1].y;
  impl_->solution = impl_->factor.solve(impl_->load);
  x[0] = glm::dvec2(0);
  for (Eigen::Index i = 0; i < n; ++i) x[i + 1] = {impl_->solution(i, 0), impl_->solution(i, 1)};
}

}  // namespace atlas::param
