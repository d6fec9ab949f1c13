#include "libatlas/param/multigrid.h"

#include <algorithm>
#include <cmath>

namespace atlas::param {
namespace {

constexpr std::uint32_t none = 0xffffffff;
constexpr std::size_t direct_limit = 300;  // rows that the envelope solver takes at the bottom
constexpr double strong_coupling = 0.06;   // against the geometric mean of the two diagonals

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

double inner(std::span<const glm::dvec2> a, std::span<const glm::vec2> b, double factor) {
  glm::dvec2 sum(0);
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * glm::dvec2(b[i]);
  return factor * (sum.x + sum.y);
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

void MultigridSolver::store_single(const SymmetricMatrix& a, Level& level) {
  const std::size_t n = a.rows();
  level.inverse_diagonal.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    level.inverse_diagonal[i] = a.diagonal[i] > 0 ? static_cast<float>(1 / a.diagonal[i]) : 0;
  }
  level.entries.resize(a.column.size());
  for (std::size_t k = 0; k < level.entries.size(); ++k) {
    level.entries[k] = {a.column[k], static_cast<float>(a.value[k])};
  }
  level.prolongation.resize(level.column.size());
  for (std::size_t k = 0; k < level.prolongation.size(); ++k) {
    level.prolongation[k] = {level.column[k], static_cast<float>(level.value[k])};
  }
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
    if (n <= direct_limit) break;
    const std::uint32_t coarse = aggregate(*a, level);
    if (coarse > n / 2) return false;
    prolongate(*a, coarse, level);
    transpose(coarse, level);
    store_single(*a, level);
    if (!multiply_prolongation(*a, coarse, level, galerkin_)) return false;
    if (!coarsen(galerkin_, level, a->column.size(), levels_[depth_ + 1].matrix)) return false;
  }
  coarsest_.factorize(*a);
  return true;
}

void MultigridSolver::solve_coarsest(Level& level) {
  coarse_load_.assign(level.load.begin(), level.load.end());
  coarse_x_.resize(level.x.size());
  coarsest_.solve(coarse_load_, coarse_x_);
  for (std::size_t i = 0; i < level.x.size(); ++i) level.x[i] = glm::vec2(coarse_x_[i]);
}

// x of the level becomes an approximate solution for its load.
void MultigridSolver::cycle(const SymmetricMatrix& finest, std::size_t depth) {
  Level& level = levels_[depth];
  if (depth == depth_) return solve_coarsest(level);
  const SymmetricMatrix& a = depth == 0 ? finest : level.matrix;
  const std::size_t n = a.rows();
  const Entry *entries = level.entries.data(), *prolongation = level.prolongation.data();
  const std::uint32_t *first = a.first.data(), *middle = a.middle.data();
  const std::uint32_t* coarse_first = level.first.data();
  glm::vec2* x = level.x.data();
  // A forward Gauss-Seidel sweep that starts from 0 meets nothing but zeros above the diagonal, and
  // leaves nothing but that part in the residual.
  for (std::size_t i = 0; i < n; ++i) {
    glm::vec2 sum = level.load[i];
    for (std::uint32_t k = first[i]; k < middle[i]; ++k) {
      sum -= entries[k].value * x[entries[k].column];
    }
    x[i] = sum * level.inverse_diagonal[i];
  }
  Level& next = levels_[depth + 1];
  std::fill(next.load.begin(), next.load.end(), glm::vec2(0));
  for (std::size_t i = 0; i < n; ++i) {
    glm::vec2 residual(0);
    for (std::uint32_t k = middle[i]; k < first[i + 1]; ++k) {
      residual -= entries[k].value * x[entries[k].column];
    }
    for (std::uint32_t k = coarse_first[i]; k < coarse_first[i + 1]; ++k) {
      next.load[prolongation[k].column] += prolongation[k].value * residual;
    }
  }
  cycle(finest, depth + 1);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::uint32_t k = coarse_first[i]; k < coarse_first[i + 1]; ++k) {
      x[i] += prolongation[k].value * next.x[prolongation[k].column];
    }
  }
  for (std::size_t i = n; i-- > 0;) {
    glm::vec2 sum = level.load[i];
    for (std::uint32_t k = first[i]; k < first[i + 1]; ++k) {
      sum -= entries[k].value * x[entries[k].column];
    }
    x[i] = sum * level.inverse_diagonal[i];
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
  std::vector<glm::vec2>& z = levels_[0].x;
  double rho = 0;
  for (int step = 0;; ++step) {
    // Brought to the size of 1 by a power of two, so that no digit is lost in single precision.
    double largest = 0;
    for (const glm::dvec2& r : residual_)
      largest = std::max({largest, std::abs(r.x), std::abs(r.y)});
    if (!std::isfinite(largest)) return false;
    const int exponent = largest > 0 ? std::ilogb(largest) : 0;
    const double shrink = std::ldexp(1.0, -exponent), grow = std::ldexp(1.0, exponent);
    for (std::size_t i = 0; i < n; ++i) levels_[0].load[i] = glm::vec2(residual_[i] * shrink);
    cycle(matrix, 0);
    const double now = inner(residual_, z, grow);
    if (!(now > accuracy.energy)) return now <= accuracy.energy;  // false for a NaN
    if (step == accuracy.most_iterations) return false;
    const double beta = step > 0 ? now / rho : 0;
    // The error falls at a steady rate; when this step will do, the next need not confirm it.
    const bool last = step > 0 && now * beta <= accuracy.energy;
    rho = now;
    for (std::size_t i = 0; i < n; ++i) {
      const glm::dvec2 own = grow * glm::dvec2(z[i]);
      direction_[i] = step > 0 ? own + beta * direction_[i] : own;
    }
    multiply(matrix, direction_, product_);
    const double alpha = rho / inner(direction_, product_);
    for (std::size_t i = 0; i < n; ++i) {
      x[i] += alpha * direction_[i];
      residual_[i] -= alpha * product_[i];
    }
    if (last) return true;
  }
}

}  // namespace atlas::param
