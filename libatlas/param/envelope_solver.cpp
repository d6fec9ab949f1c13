#include <algorithm>
#include <array>
#include <cmath>

#include "libatlas/param/linear_solver.h"

namespace atlas::param {
namespace {

constexpr std::uint32_t unseen = 0xffffffff;

// Blocks of 4 x 4, column after column: what one processor's registers hold.
constexpr std::size_t side = 4, block_size = side * side;

// Two neighbouring rows of a column. Vectors of this size are elementary to every 64-bit processor,
// and their arithmetic is that of their elements.
using Pair = double __attribute__((vector_size(16), may_alias));
struct Block {
  Pair part[block_size / 2];
};

Block load(const double* from) {
  Block out;
  for (std::size_t i = 0; i < block_size / 2; ++i)
    out.part[i] = reinterpret_cast<const Pair*>(from)[i];
  return out;
}

void store(const Block& block, double* to) {
  for (std::size_t i = 0; i < block_size / 2; ++i) reinterpret_cast<Pair*>(to)[i] = block.part[i];
}

// sum -= a b'
inline void subtract_product(const double* a, const double* b, Block& sum) {
#pragma GCC unroll 1  // else the sum does not stay in registers
  for (std::size_t k = 0; k < side; ++k) {
    const Pair low = reinterpret_cast<const Pair*>(a + side * k)[0];
    const Pair high = reinterpret_cast<const Pair*>(a + side * k)[1];
    for (std::size_t j = 0; j < side; ++j) {
      const double factor = b[side * k + j];
      sum.part[2 * j] -= low * factor;
      sum.part[2 * j + 1] -= high * factor;
    }
  }
}

}  // namespace

inline double* EnvelopeSolver::block(std::size_t row, std::size_t column) {
  return factor_.data() + block_size * (row_[row] + (column - first_[row]));
}

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

void EnvelopeSolver::find_envelope(const SymmetricMatrix& matrix) {
  const std::size_t n = matrix.rows(), blocks = (n + side - 1) / side;
  first_.resize(blocks);
  row_.resize(blocks + 1);
  row_[0] = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    std::uint32_t first = static_cast<std::uint32_t>(side * b);
    for (std::size_t i = side * b; i < std::min(side * (b + 1), n); ++i) {
      const std::uint32_t v = order_[i];
      for (std::uint32_t k = matrix.first[v]; k < matrix.first[v + 1]; ++k) {
        first = std::min(first, position_[matrix.column[k]]);
      }
    }
    first_[b] = first / side;
    row_[b + 1] = row_[b] + (b - first_[b] + 1);
  }
}

// Copies the matrix into the envelope; rows beyond the last are 0.
void EnvelopeSolver::fill(const SymmetricMatrix& matrix) {
  factor_.assign(block_size * row_.back(), 0);
  for (std::uint32_t i = 0; i < matrix.rows(); ++i) {
    const std::uint32_t v = order_[i];
    double* row = factor_.data() + block_size * row_[i / side] + i % side;
    const std::uint32_t first = side * first_[i / side];
    row[side * (i - first)] = matrix.diagonal[v];
    for (std::uint32_t k = matrix.first[v]; k < matrix.first[v + 1]; ++k) {
      const std::uint32_t j = position_[matrix.column[k]];
      if (j < i) row[side * (j - first)] += matrix.value[k];
    }
  }
}

// Block (b, c) of the factor, all before it done.
void EnvelopeSolver::eliminate(std::size_t b, std::size_t c) {
  double* own = block(b, c);
  Block sum = load(own);
  const std::size_t begin = std::max(first_[b], first_[c]);
  const double *a = block(b, begin), *other = block(c, begin);
  for (; a != own; a += block_size, other += block_size) subtract_product(a, other, sum);
  if (b != c) {
    for (std::size_t j = 0; j < side; ++j) {
      const double scale = inverse_pivot_[side * c + j];
      sum.part[2 * j] *= scale;
      sum.part[2 * j + 1] *= scale;
      for (std::size_t k = j + 1; k < side; ++k) {
        sum.part[2 * k] -= sum.part[2 * j] * other[side * j + k];
        sum.part[2 * k + 1] -= sum.part[2 * j + 1] * other[side * j + k];
      }
    }
  }
  store(sum, own);
}

void EnvelopeSolver::factorize(const SymmetricMatrix& matrix, bool same_pattern) {
  const std::size_t n = matrix.rows();
  if (!same_pattern) {
    order(matrix);
    find_envelope(matrix);
  }
  fill(matrix);
  const std::size_t blocks = first_.size();
  inverse_pivot_.assign(side * blocks, 0);
  for (std::size_t b = 0; b < blocks; ++b) {
    for (std::size_t c = first_[b]; c <= b; ++c) eliminate(b, c);
    double* own = block(b, b);
    for (std::size_t j = 0; j < std::min(side, n - side * b); ++j) {
      const std::uint32_t v = order_[side * b + j];
      const double pivot = own[side * j + j];
      if (held_[v] == 0 && pivot > 1e-15 * matrix.diagonal[v]) {
        inverse_pivot_[side * b + j] = 1 / std::sqrt(pivot);
      }
      for (std::size_t r = j + 1; r < side; ++r) own[side * j + r] *= inverse_pivot_[side * b + j];
      for (std::size_t k = j + 1; k < side; ++k) {
        for (std::size_t r = k; r < side; ++r) {
          own[side * k + r] -= own[side * j + r] * own[side * j + k];
        }
      }
    }
  }
}

void EnvelopeSolver::solve(std::span<const glm::dvec2> load, std::span<glm::dvec2> x) {
  const std::size_t n = order_.size(), blocks = first_.size();
  work_.assign(side * blocks, glm::dvec2(0));
  glm::dvec2* work = work_.data();
  for (std::size_t i = 0; i < n; ++i) work[i] = load[order_[i]];
  for (std::size_t b = 0; b < blocks; ++b) {
    std::array<glm::dvec2, side> sum;
    for (std::size_t r = 0; r < side; ++r) sum[r] = work[side * b + r];
    const double* column = block(b, first_[b]);
    for (std::size_t i = side * first_[b]; i < side * b; ++i, column += side) {
      for (std::size_t r = 0; r < side; ++r) sum[r] -= column[r] * work[i];
    }
    for (std::size_t j = 0; j < side; ++j, column += side) {
      sum[j] *= inverse_pivot_[side * b + j];
      for (std::size_t r = j + 1; r < side; ++r) sum[r] -= column[r] * sum[j];
      work[side * b + j] = sum[j];
    }
  }
  for (std::size_t b = blocks; b-- > 0;) {
    std::array<glm::dvec2, side> known;
    const double* own = block(b, b);
    for (std::size_t j = side; j-- > 0;) {
      known[j] = work[side * b + j];
      for (std::size_t r = j + 1; r < side; ++r) known[j] -= own[side * j + r] * known[r];
      work[side * b + j] = known[j] *= inverse_pivot_[side * b + j];
    }
    const double* column = block(b, first_[b]);
    for (std::size_t i = side * first_[b]; i < side * b; ++i, column += side) {
      const glm::dvec2 low = column[0] * known[0] + column[1] * known[1];
      work[i] -= low + (column[2] * known[2] + column[3] * known[3]);
    }
  }
  for (std::size_t i = 0; i < n; ++i) x[order_[i]] = work[i];
}

}  // namespace atlas::param
