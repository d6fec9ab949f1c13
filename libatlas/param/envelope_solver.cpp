#include <algorithm>
#include <cmath>

#include "libatlas/param/linear_solver.h"

namespace atlas::param {
namespace {

constexpr std::uint32_t unseen = 0xffffffff;

// Four running sums, so that the processor need not wait for each addition; the order is fixed.
double dot(const double* a, const double* b, std::size_t n) {
  double s0 = 0, s1 = 0, s2 = 0, s3 = 0;
  std::size_t k = 0;
  for (; k + 4 <= n; k += 4) {
    s0 += a[k] * b[k];
    s1 += a[k + 1] * b[k + 1];
    s2 += a[k + 2] * b[k + 2];
    s3 += a[k + 3] * b[k + 3];
  }
  for (; k < n; ++k) s0 += a[k] * b[k];
  return (s0 + s1) + (s2 + s3);
}

}  // namespace

// Breadth-first from start over vertices whose position_ is unseen; fills queue_ and returns the
// last.
std::uint32_t EnvelopeSolver::sweep(const SymmetricMatrix& matrix, std::uint32_t start) {
  queue_.assign(1, start);
  position_[start] = 0;
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    const std::uint32_t v = queue_[i];
    for (std::uint32_t k = matrix.first[v]; k < matrix.first[v + 1]; ++k) {
      const std::uint32_t w = matrix.column[k];
      if (position_[w] != unseen) continue;
      position_[w] = static_cast<std::uint32_t>(queue_.size());
      queue_.push_back(w);
    }
  }
  return queue_.back();
}

void EnvelopeSolver::order(const SymmetricMatrix& matrix) {
  const std::uint32_t n = static_cast<std::uint32_t>(matrix.rows());
  order_.clear();
  position_.assign(n, unseen);
  held_.assign(n, 0);
  for (std::uint32_t v = 0; v < n; ++v) {
    if (position_[v] != unseen) continue;
    std::uint32_t start = v;
    for (int pass = 0; pass < 2; ++pass) {  // the farthest vertex is a good end to start from
      const std::uint32_t end = sweep(matrix, start);
      for (const std::uint32_t w : queue_) position_[w] = unseen;
      start = end;
    }
    sweep(matrix, start);
    held_[start] = 1;  // the last of its piece to be eliminated: its pivot is nothing but rounding
    order_.insert(order_.end(), queue_.begin(), queue_.end());
  }
  std::reverse(order_.begin(), order_.end());
  for (std::uint32_t i = 0; i < n; ++i) position_[order_[i]] = i;
}

void EnvelopeSolver::factorize(const SymmetricMatrix& matrix) {
  const std::uint32_t n = static_cast<std::uint32_t>(matrix.rows());
  order(matrix);
  first_.resize(n);
  row_.resize(n + 1);
  row_[0] = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t v = order_[i];
    first_[i] = i;
    for (std::uint32_t k = matrix.first[v]; k < matrix.first[v + 1]; ++k) {
      first_[i] = std::min(first_[i], position_[matrix.column[k]]);
    }
    row_[i + 1] = row_[i] + (i - first_[i]);
  }
  factor_.assign(row_[n], 0);
  inverse_pivot_.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t v = order_[i];
    double* row = factor_.data() + row_[i];
    for (std::uint32_t k = matrix.first[v]; k < matrix.first[v + 1]; ++k) {
      const std::uint32_t j = position_[matrix.column[k]];
      if (j < i) row[j - first_[i]] += matrix.value[k];
    }
    double pivot = matrix.diagonal[v];
    for (std::uint32_t j = first_[i]; j < i; ++j) {
      const std::uint32_t begin = std::max(first_[i], first_[j]);
      const double* other = factor_.data() + row_[j];
      const double value = row[j - first_[i]] -
                           dot(row + (begin - first_[i]), other + (begin - first_[j]), j - begin);
      row[j - first_[i]] = value * inverse_pivot_[j];
      pivot -= row[j - first_[i]] * row[j - first_[i]];
    }
    const bool regular = held_[v] == 0 && pivot > 1e-15 * matrix.diagonal[v];
    inverse_pivot_[i] = regular ? 1 / std::sqrt(pivot) : 0;
  }
}

void EnvelopeSolver::solve(std::span<const glm::dvec2> load, std::span<glm::dvec2> x) {
  const std::uint32_t n = static_cast<std::uint32_t>(order_.size());
  work_.resize(n);
  glm::dvec2* work = work_.data();
  for (std::uint32_t i = 0; i < n; ++i) {
    glm::dvec2 even = load[order_[i]], odd(0);  // two sums: neither waits for the other
    const double* row = factor_.data() + row_[i];
    const std::uint32_t length = i - first_[i];
    const glm::dvec2* known = work + first_[i];
    std::uint32_t k = 0;
    for (; k + 2 <= length; k += 2) {
      even -= row[k] * known[k];
      odd -= row[k + 1] * known[k + 1];
    }
    if (k < length) even -= row[k] * known[k];
    work[i] = (even + odd) * inverse_pivot_[i];
  }
  for (std::uint32_t i = n; i-- > 0;) {
    const glm::dvec2 value = work[i] * inverse_pivot_[i];
    const double* row = factor_.data() + row_[i];
    const std::uint32_t length = i - first_[i];
    glm::dvec2* above = work + first_[i];
    for (std::uint32_t k = 0; k < length; ++k) above[k] -= row[k] * value;
    x[order_[i]] = value;
  }
}

}  // namespace atlas::param
