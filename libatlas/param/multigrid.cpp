#include "libatlas/param/multigrid.h"

#include <algorithm>
#include <cmath>

namespace atlas::param {
namespace {

constexpr std::uint32_t none = 0xffffffff;
constexpr std::size_t direct_limit = 300;   // rows that the envelope solver takes at the bottom
constexpr std::size_t large_setup = 20000;  // rows above which a set-up's memory is given back
constexpr double strong_coupling = 0.06;    // against the geometric mean of the two diagonals

// out = a x, both halves at once from the lower one; returns x . out.
double multiply(const SymmetricMatrix& a, std::span<const glm::dvec2> x,
                std::span<glm::dvec2> out) {
  glm::dvec2 diagonal(0), lower(0);
  for (std::size_t i = 0; i < a.rows(); ++i) {
    const glm::dvec2 own = x[i], on = a.diagonal[i] * own;
    glm::dvec2 below(0);
    for (std::uint32_t k = a.first[i]; k < a.middle[i]; ++k) {
      const std::uint32_t c = a.column[k];
      below += a.value[k] * x[c];
      out[c] += a.value[k] * own;
    }
    out[i] = on + below;
    diagonal += own * on;
    lower += own * below;
  }
  const glm::dvec2 sum = diagonal + 2.0 * lower;
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
  std::vector<std::uint32_t>& group = setup_.aggregate;
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
  setup_.column.clear();
  setup_.value.clear();
  std::vector<std::uint32_t> place(coarse, none);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t begin = static_cast<std::uint32_t>(setup_.column.size());
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
        place[group] = static_cast<std::uint32_t>(setup_.column.size());
        setup_.column.push_back(group);
        setup_.value.push_back(0);
      }
      setup_.value[place[group]] += v;
    };
    // The row's own coefficient is what the others leave of its sum: constants stay constant.
    add(setup_.aggregate[i], 1 - damping * (a.diagonal[i] - kept));
    for (std::uint32_t k = a.first[i]; k < a.first[i + 1]; ++k) {
      add(setup_.aggregate[a.column[k]], -damping * a.value[k]);
    }
  }
  level.first[n] = static_cast<std::uint32_t>(setup_.column.size());
}

void MultigridSolver::transpose(std::uint32_t coarse, const Level& level) {
  setup_.column_first.assign(coarse + 1, 0);
  for (const std::uint32_t c : setup_.column) ++setup_.column_first[c + 1];
  for (std::uint32_t c = 0; c < coarse; ++c) setup_.column_first[c + 1] += setup_.column_first[c];
  setup_.row.resize(setup_.column.size());
  setup_.column_value.resize(setup_.column.size());
  std::vector<std::uint32_t> fill(setup_.column_first.begin(), setup_.column_first.end() - 1);
  for (std::uint32_t i = 0; i + 1 < level.first.size(); ++i) {
    for (std::uint32_t k = level.first[i]; k < level.first[i + 1]; ++k) {
      const std::uint32_t at = fill[setup_.column[k]]++;
      setup_.row[at] = i;
      setup_.column_value[at] = setup_.value[k];
    }
  }
}

// Rows of A P. False: there are more than so many entries, as about vertices of huge valence.
bool MultigridSolver::multiply_prolongation(const SymmetricMatrix& a, std::uint32_t coarse,
                                            const Level& level) {
  const std::size_t most_entries = 4 * (a.column.size() + a.rows());
  const std::uint32_t n = static_cast<std::uint32_t>(a.rows());
  Setup& s = setup_;
  s.product_first.resize(n + 1);
  s.product_column.clear();
  s.product_value.clear();
  std::vector<std::uint32_t> place(coarse, none);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t begin = static_cast<std::uint32_t>(s.product_column.size());
    s.product_first[i] = begin;
    const auto add = [&](std::uint32_t j, double v) {
      for (std::uint32_t k = level.first[j]; k < level.first[j + 1]; ++k) {
        std::uint32_t& at = place[s.column[k]];
        if (at == none || at < begin) {
          at = static_cast<std::uint32_t>(s.product_column.size());
          s.product_column.push_back(s.column[k]);
          s.product_value.push_back(0);
        }
        s.product_value[at] += v * s.value[k];
      }
    };
    add(i, a.diagonal[i]);
    for (std::uint32_t k = a.first[i]; k < a.first[i + 1]; ++k) add(a.column[k], a.value[k]);
    if (s.product_column.size() > most_entries) return false;
  }
  s.product_first[n] = static_cast<std::uint32_t>(s.product_column.size());
  return true;
}

// The Galerkin product P' A P. False: likewise.
bool MultigridSolver::coarsen(std::size_t most_entries, SymmetricMatrix& out) const {
  const Setup& s = setup_;
  const std::uint32_t coarse = static_cast<std::uint32_t>(s.column_first.size() - 1);
  out.diagonal.assign(coarse, 0);
  out.first.resize(coarse + 1);
  out.column.clear();
  out.value.clear();
  std::vector<std::uint32_t> place(coarse, none);
  for (std::uint32_t row = 0; row < coarse; ++row) {
    const std::uint32_t begin = static_cast<std::uint32_t>(out.column.size());
    out.first[row] = begin;
    for (std::uint32_t m = s.column_first[row]; m < s.column_first[row + 1]; ++m) {
      const std::uint32_t i = s.row[m];
      for (std::uint32_t k = s.product_first[i]; k < s.product_first[i + 1]; ++k) {
        const double v = s.column_value[m] * s.product_value[k];
        const std::uint32_t c = s.product_column[k];
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

void MultigridSolver::store_single(const SymmetricMatrix& a, Level& level) const {
  const std::size_t n = a.rows();
  level.inverse_diagonal.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    level.inverse_diagonal[i] = a.diagonal[i] > 0 ? static_cast<float>(1 / a.diagonal[i]) : 0;
  }
  level.entries.resize(a.column.size());
  for (std::size_t k = 0; k < level.entries.size(); ++k) {
    level.entries[k] = {a.column[k], static_cast<float>(a.value[k])};
  }
  level.prolongation.resize(setup_.column.size());
  for (std::size_t k = 0; k < level.prolongation.size(); ++k) {
    level.prolongation[k] = {setup_.column[k], static_cast<float>(setup_.value[k])};
  }
}

bool MultigridSolver::build(const SymmetricMatrix& matrix) {
  const bool built = build_levels(matrix);
  // What charts of some hundred thousand triangles need for a moment would double what they need.
  if (matrix.rows() > large_setup) {
    setup_ = {};
    for (Level& level : levels_) level.matrix.column = {}, level.matrix.value = {};
  }
  return built;
}

bool MultigridSolver::build_levels(const SymmetricMatrix& matrix) {
  const SymmetricMatrix* a = &matrix;
  depth_ = 0;
  for (;; ++depth_) {
    if (levels_.size() < depth_ + 2) levels_.resize(depth_ + 2);
    if (depth_ > 0) a = &levels_[depth_].matrix;  // resizing may have moved it
    Level& level = levels_[depth_];
    const std::size_t n = a->rows();
    if (n <= direct_limit) break;
    const std::uint32_t coarse = aggregate(*a, level);
    if (coarse > n / 2) return false;
    prolongate(*a, coarse, level);
    transpose(coarse, level);
    if (!multiply_prolongation(*a, coarse, level)) return false;
    if (!coarsen(a->column.size(), levels_[depth_ + 1].matrix)) return false;
    store_single(*a, level);
  }
  coarsest_.factorize(*a);
  for (std::size_t depth = 0; depth <= depth_; ++depth) {
    const std::size_t n = depth == 0 ? matrix.rows() : levels_[depth].matrix.rows();
    levels_[depth].x.resize(n);
    levels_[depth].load.resize(n);
  }
  return true;
}

void MultigridSolver::solve_coarsest(Level& level) {
  coarse_load_.assign(level.load.begin(), level.load.end());
  coarse_x_.resize(level.x.size());
  coarsest_.solve(coarse_load_, coarse_x_);
  for (std::size_t i = 0; i < level.x.size(); ++i) level.x[i] = glm::vec2(coarse_x_[i]);
}

// A forward Gauss-Seidel sweep that starts from 0 meets nothing but zeros above the diagonal, and
// leaves nothing but that part in the residual, which becomes the load of the next level.
void MultigridSolver::smooth_down(const SymmetricMatrix& a, std::size_t depth) {
  Level& level = levels_[depth];
  const std::size_t n = a.rows();
  const Entry *entries = level.entries.data(), *prolongation = level.prolongation.data();
  const std::uint32_t *first = a.first.data(), *middle = a.middle.data();
  const std::uint32_t* coarse_first = level.first.data();
  glm::vec2* x = level.x.data();
  for (std::size_t i = 0; i < n; ++i) {
    glm::vec2 sum = level.load[i];
    for (std::uint32_t k = first[i]; k < middle[i]; ++k) {
      sum -= entries[k].value * x[entries[k].column];
    }
    x[i] = sum * level.inverse_diagonal[i];
  }
  std::vector<glm::vec2>& load = levels_[depth + 1].load;
  std::fill(load.begin(), load.end(), glm::vec2(0));
  for (std::size_t i = 0; i < n; ++i) {
    glm::vec2 residual(0);
    for (std::uint32_t k = middle[i]; k < first[i + 1]; ++k) {
      residual -= entries[k].value * x[entries[k].column];
    }
    for (std::uint32_t k = coarse_first[i]; k < coarse_first[i + 1]; ++k) {
      load[prolongation[k].column] += prolongation[k].value * residual;
    }
  }
}

// The next level's solution comes up, and a backward sweep makes the cycle symmetric.
void MultigridSolver::smooth_up(const SymmetricMatrix& a, std::size_t depth) {
  Level& level = levels_[depth];
  const std::size_t n = a.rows();
  const Entry *entries = level.entries.data(), *prolongation = level.prolongation.data();
  const std::uint32_t* first = a.first.data();
  const std::uint32_t* coarse_first = level.first.data();
  const glm::vec2* coarse_x = levels_[depth + 1].x.data();
  glm::vec2* x = level.x.data();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::uint32_t k = coarse_first[i]; k < coarse_first[i + 1]; ++k) {
      x[i] += prolongation[k].value * coarse_x[prolongation[k].column];
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

// x of the level becomes an approximate solution for its load.
void MultigridSolver::cycle(const SymmetricMatrix& finest, std::size_t depth) {
  if (depth == depth_) return solve_coarsest(levels_[depth]);
  const SymmetricMatrix& a = depth == 0 ? finest : levels_[depth].matrix;
  smooth_down(a, depth);
  cycle(finest, depth + 1);
  smooth_up(a, depth);
}

bool MultigridSolver::solve(const SymmetricMatrix& matrix, std::span<const glm::dvec2> load,
                            const Accuracy& accuracy, std::span<glm::dvec2> x) {
  const std::size_t n = matrix.rows();
  residual_.resize(n);
  product_.resize(n);
  direction_.resize(n);
  multiply(matrix, x, product_);
  double largest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    residual_[i] = load[i] - product_[i];
    largest = std::max({largest, std::abs(residual_[i].x), std::abs(residual_[i].y)});
  }
  std::vector<glm::vec2>& z = levels_[0].x;
  double rho = 0, goal = accuracy.energy;
  for (int step = 0;; ++step) {
    // Brought to the size of 1 by a power of two, so that no digit is lost in single precision.
    if (!std::isfinite(largest)) return false;
    const int exponent = largest > 0 ? std::ilogb(largest) : 0;
    const double shrink = std::ldexp(1.0, -exponent), grow = std::ldexp(1.0, exponent);
    for (std::size_t i = 0; i < n; ++i) levels_[0].load[i] = glm::vec2(residual_[i] * shrink);
    cycle(matrix, 0);
    const double now = inner(residual_, z, grow);
    if (!(now > goal)) return now <= goal;  // false for a NaN
    if (step == 0) goal = std::max(goal, accuracy.share * now);
    if (step == accuracy.most_iterations) return false;
    const double beta = step > 0 ? now / rho : 0;
    // The error falls at a steady rate; when this step will do, the next need not confirm it.
    const bool last = step > 0 && now * beta <= goal;
    rho = now;
    for (std::size_t i = 0; i < n; ++i) {
      const glm::dvec2 own = grow * glm::dvec2(z[i]);
      direction_[i] = step > 0 ? own + beta * direction_[i] : own;
    }
    const double alpha = rho / multiply(matrix, direction_, product_);
    if (last) {
      for (std::size_t i = 0; i < n; ++i) x[i] += alpha * direction_[i];
      return true;
    }
    largest = 0;
    for (std::size_t i = 0; i < n; ++i) {
      x[i] += alpha * direction_[i];
      residual_[i] -= alpha * product_[i];
      largest = std::max({largest, std::abs(residual_[i].x), std::abs(residual_[i].y)});
    }
  }
}

}  // namespace atlas::param
