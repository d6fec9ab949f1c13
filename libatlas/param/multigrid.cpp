#include "libatlas/param/multigrid.h"

#include <algorithm>
#include <cmath>

namespace atlas::param {
namespace {

constexpr std::uint32_t none = 0xffffffff;
constexpr std::size_t direct_limit = 300;  // rows that the envelope solver takes at the bottom
constexpr double strong_coupling = 0.06;   // against the geometric mean of the two diagonals

void invert_diagonal(const SymmetricMatrix& a, std::vector<double>& out) {
  out.resize(a.rows());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = a.diagonal[i] > 0 ? 1 / a.diagonal[i] : 0;
}

void multiply(const SymmetricMatrix& a, std::span<const glm::dvec2> x, std::span<glm::dvec2> out) {
  for (std::size_t i = 0; i < a.rows(); ++i) {
    glm::dvec2 sum = a.diagonal[i] * x[i];
    for (std::uint32_t k = a.first[i]; k < a.first[i + 1]; ++k) sum += a.value[k] * x[a.column[k]];
    out[i] = sum;
  }
}

double inner(std::span<const glm::dvec2> a, std::span<const glm::dvec2> b) {
  glm::dvec2 sum(0);
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum.x + sum.y;
}

}  // namespace

// Gives every row an aggregate; returns how many there are.
std::uint32_t MultigridSolver::aggregate(const SymmetricMatrix& a, Level& level) {
  const std::uint32_t n = static_cast<std::uint32_t>(a.rows());
  std::vector<std::uint32_t>& group = level.aggregate;
  group.assign(n, none);
  const auto strong = [&](std::uint32_t i, std::uint32_t k) {
    const double v = a.value[k];
    return v < 0 &&
           v * v > strong_coupling * strong_coupling * a.diagonal[i] * a.diagonal[a.column[k]];
  };
  std::uint32_t count = 0;
  // Whole neighbourhoods first,
  for (std::uint32_t i = 0; i < n; ++i) {
    if (group[i] != none) continue;
    bool free = true;
    for (std::uint32_t k = a.first[i]; k < a.first[i + 1] && free; ++k) {
      free = !strong(i, k) || group[a.column[k]] == none;
    }
    if (!free) continue;
    group[i] = count;
    for (std::uint32_t k = a.first[i]; k < a.first[i + 1]; ++k) {
      if (strong(i, k)) group[a.column[k]] = count;
    }
    ++count;
  }
  // then what is left joins the neighbour it hangs on most,
  std::vector<std::uint32_t>& join = level.first;  // free at this stage
  join.assign(n, none);
  for (std::uint32_t i = 0; i < n; ++i) {
    if (group[i] != none) continue;
    double least = 0;
    for (std::uint32_t k = a.first[i]; k < a.first[i + 1]; ++k) {
      if (group[a.column[k]] == none || a.value[k] >= least) continue;
      least = a.value[k];
      join[i] = group[a.column[k]];
    }
  }
  // and what has no such neighbour stands alone.
  for (std::uint32_t i = 0; i < n; ++i) {
    if (group[i] == none) group[i] = join[i] != none ? join[i] : count++;
  }
  return count;
}

// Rows of P = (I - omega D^-1 A) P0, where P0 has a one at each row's aggregate.
void MultigridSolver::prolongate(const SymmetricMatrix& a, std::uint32_t coarse, Level& level) {
  const std::uint32_t n = static_cast<std::uint32_t>(a.rows());
  level.first.resize(n + 1);
  level.column.clear();
  level.value.clear();
  std::vector<std::uint32_t> place(coarse, none);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t begin = static_cast<std::uint32_t>(level.column.size());
    level.first[i] = begin;
    // Half the row's absolute sum bounds the diagonal from above where couplings of both signs
    // meet.
    double sum = a.diagonal[i], kept = a.diagonal[i];
    for (std::uint32_t k = a.first[i]; k < a.first[i + 1]; ++k) {
      sum += std::abs(a.value[k]);
      kept += a.value[k];
    }
    const double damping = sum > 0 ? (4.0 / 3.0) / sum : 0;
    const auto add = [&](std::uint32_t group, double v) {
      if (place[group] == none || place[group] < begin) {
        place[group] = static_cast<std::uint32_t>(level.column.size());
        level.column.push_back(group);
        level.value.push_back(0);
      }
      level.value[place[group]] += v;
    };
    // The row's own coefficient is what the others leave of its sum: constants stay constant.
    add(level.aggregate[i], 1 - damping * (a.diagonal[i] - kept));
    for (std::uint32_t k = a.first[i]; k < a.first[i + 1]; ++k) {
      add(level.aggregate[a.column[k]], -damping * a.value[k]);
    }
  }
  level.first[n] = static_cast<std::uint32_t>(level.column.size());
}

void MultigridSolver::transpose(std::uint32_t coarse, Level& level) {
  level.column_first.assign(coarse + 1, 0);
  for (const std::uint32_t c : level.column) ++level.column_first[c + 1];
  for (std::uint32_t c = 0; c < coarse; ++c) level.column_first[c + 1] += level.column_first[c];
  level.row.resize(level.column.size());
  level.column_value.resize(level.column.size());
  std::vector<std::uint32_t> fill(level.column_first.begin(), level.column_first.end() - 1);
  for (std::uint32_t i = 0; i + 1 < level.first.size(); ++i) {
    for (std::uint32_t k = level.first[i]; k < level.first[i + 1]; ++k) {
      const std::uint32_t at = fill[level.column[k]]++;
      level.row[at] = i;
      level.column_value[at] = level.value[k];
    }
  }
}

// Rows of A P. False: there are more than so many entries, as about vertices of huge valence.
bool MultigridSolver::multiply_prolongation(const SymmetricMatrix& a, std::uint32_t coarse,
                                            const Level& level, Product& out) {
  const std::size_t most_entries = 4 * (a.column.size() + a.rows());
  const std::uint32_t n = static_cast<std::uint32_t>(a.rows());
  out.first.resize(n + 1);
  out.entries.clear();
  std::vector<std::uint32_t> place(coarse, none);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t begin = static_cast<std::uint32_t>(out.entries.size());
    out.first[i] = begin;
    const auto add = [&](std::uint32_t j, double v) {
      for (std::uint32_t k = level.first[j]; k < level.first[j + 1]; ++k) {
        std::uint32_t& at = place[level.column[k]];
        if (at == none || at < begin) {
          at = static_cast<std::uint32_t>(out.entries.size());
          out.entries.push_back({level.column[k], 0});
        }
        out.entries[at].value += v * level.value[k];
      }
    };
    add(i, a.diagonal[i]);
    for (std::uint32_t k = a.first[i]; k < a.first[i + 1]; ++k) add(a.column[k], a.value[k]);
    if (out.entries.size() > most_entries) return false;
  }
  out.first[n] = static_cast<std::uint32_t>(out.entries.size());
  return true;
}

// The Galerkin product P' A P. False: likewise.
bool MultigridSolver::coarsen(const Product& product, const Level& level, std::size_t most_entries,
                              SymmetricMatrix& out) {
  const std::uint32_t coarse = static_cast<std::uint32_t>(level.column_first.size() - 1);
  out.diagonal.assign(coarse, 0);
  out.first.resize(coarse + 1);
  out.column.clear();
  out.value.clear();
  std::vector<std::uint32_t> place(coarse, none);
  for (std::uint32_t row = 0; row < coarse; ++row) {
    const std::uint32_t begin = static_cast<std::uint32_t>(out.column.size());
    out.first[row] = begin;
    for (std::uint32_t m = level.column_first[row]; m < level.column_first[row + 1]; ++m) {
      const std::uint32_t i = level.row[m];
      for (std::uint32_t k = product.first[i]; k < product.first[i + 1]; ++k) {
        const double v = level.column_value[m] * product.entries[k].value;
        const std::uint32_t c = product.entries[k].column;
        if (c == row) {
          out.diagonal[row] += v;
          continue;
        }
        if (place[c] == none || place[c] < begin) {
          place[c] = static_cast<std::uint32_t>(out.column.size());
          out.column.push_back(c);
          out.value.push_back(0);
        }
        out.value[place[c]] += v;
      }
    }
    if (out.column.size() > most_entries) return false;
  }
  out.first[coarse] = static_cast<std::uint32_t>(out.column.size());
  partition_rows(out);
  return true;
}

bool MultigridSolver::build(const SymmetricMatrix& matrix) {
  const SymmetricMatrix* a = &matrix;
  depth_ = 0;
  for (;; ++depth_) {
    if (levels_.size() < depth_ + 2) levels_.resize(depth_ + 2);
    if (depth_ > 0) a = &levels_[depth_].matrix;  // resizing may have moved it
    Level& level = levels_[depth_];
    const std::size_t n = a->rows();
    level.x.resize(n);
    level.load.resize(n);
    level.residual.resize(n);
    if (n <= direct_limit) break;
    invert_diagonal(*a, level.inverse_diagonal);
    const std::uint32_t coarse = aggregate(*a, level);
    if (coarse > n / 2) return false;
    prolongate(*a, coarse, level);
    transpose(coarse, level);
    if (!multiply_prolongation(*a, coarse, level, galerkin_)) return false;
    if (!coarsen(galerkin_, level, a->column.size(), levels_[depth_ + 1].matrix)) return false;
  }
  coarsest_.factorize(*a);
  return true;
}

// x of the level becomes an approximate solution for its load.
void MultigridSolver::cycle(const SymmetricMatrix& finest, std::size_t depth) {
  Level& level = levels_[depth];
  if (depth == depth_) return coarsest_.solve(level.load, level.x);
  const SymmetricMatrix& a = depth == 0 ? finest : level.matrix;
  const std::size_t n = a.rows();
  // A forward Gauss-Seidel sweep that starts from 0 meets nothing but zeros above the diagonal, and
  // leaves nothing but that part in the residual.
  for (std::size_t i = 0; i < n; ++i) {
    glm::dvec2 sum = level.load[i];
    for (std::uint32_t k = a.first[i]; k < a.middle[i]; ++k)
      sum -= a.value[k] * level.x[a.column[k]];
    level.x[i] = sum * level.inverse_diagonal[i];
  }
  for (std::size_t i = 0; i < n; ++i) {
    glm::dvec2 sum(0);
    for (std::uint32_t k = a.middle[i]; k < a.first[i + 1]; ++k) {
      sum -= a.value[k] * level.x[a.column[k]];
    }
    level.residual[i] = sum;
  }
  Level& next = levels_[depth + 1];
  for (std::size_t c = 0; c < next.load.size(); ++c) {
    glm::dvec2 sum(0);
    for (std::uint32_t k = level.column_first[c]; k < level.column_first[c + 1]; ++k) {
      sum += level.column_value[k] * level.residual[level.row[k]];
    }
    next.load[c] = sum;
  }
  cycle(finest, depth + 1);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::uint32_t k = level.first[i]; k < level.first[i + 1]; ++k) {
      level.x[i] += level.value[k] * next.x[level.column[k]];
    }
  }
  for (std::size_t i = n; i-- > 0;) {
    glm::dvec2 sum = level.load[i];
    for (std::uint32_t k = a.first[i]; k < a.first[i + 1]; ++k) {
      sum -= a.value[k] * level.x[a.column[k]];
    }
    level.x[i] = sum * level.inverse_diagonal[i];
  }
}

bool MultigridSolver::solve(const SymmetricMatrix& matrix, std::span<const glm::dvec2> load,
                            const Accuracy& accuracy, std::span<glm::dvec2> x) {
  const std::size_t n = matrix.rows();
  residual_.resize(n);
  product_.resize(n);
  direction_.resize(n);
  multiply(matrix, x, residual_);
  for (std::size_t i = 0; i < n; ++i) residual_[i] = load[i] - residual_[i];
  std::vector<glm::dvec2>& z = levels_[0].x;
  double rho = 0;
  for (int step = 0;; ++step) {
    std::copy(residual_.begin(), residual_.end(), levels_[0].load.begin());
    cycle(matrix, 0);
    const double now = inner(residual_, z);
    if (!(now > accuracy.energy)) return now <= accuracy.energy;  // false for a NaN
    if (step == accuracy.most_iterations) return false;
    const double beta = step > 0 ? now / rho : 0;
    rho = now;
    for (std::size_t i = 0; i < n; ++i) {
      direction_[i] = step > 0 ? z[i] + beta * direction_[i] : z[i];
    }
    multiply(matrix, direction_, product_);
    const double alpha = rho / inner(direction_, product_);
    for (std::size_t i = 0; i < n; ++i) {
      x[i] += alpha * direction_[i];
      residual_[i] -= alpha * product_[i];
    }
  }
}

}  // namespace atlas::param
