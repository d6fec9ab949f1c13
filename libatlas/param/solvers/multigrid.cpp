#include "libatlas/param/solvers/multigrid.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

namespace atlas::param {
namespace {

constexpr std::size_t direct_limit = 300;  // rows that the envelope solver handles on the coarsest
                                           // level
// Up to this value of half a cotangent single precision is enough: rounding then moves no corner of
// a sliver by more than 3e-5 of its altitude.
constexpr double most_single_coupling = 500;

// Both coordinates in one register. Every 64-bit processor has such vectors, and their arithmetic
// is elementwise.
template <class Real>
struct Pairs {
  using type __attribute__((vector_size(2 * sizeof(Real)), may_alias)) = Real;
};
template <class Real>
using PairOf = typename Pairs<Real>::type;

template <class Real>
PairOf<Real>* pairs(std::vector<glm::vec<2, Real>>& v) {
  return reinterpret_cast<PairOf<Real>*>(v.data());
}

glm::dvec2 in_double(Vec2d v) {
  return to_glm(v);
}
template <class Real>
glm::dvec2 in_double(const glm::vec<2, Real>& v) {
  return glm::dvec2(v);
}

// load -= factor K x, with both halves of K computed from the lower one.
template <class Real, class Vector>
void subtract_product(const GraphLaplacian<Real>& matrix, const Vector& x, double factor,
                      std::span<glm::dvec2> load) {
  for (std::size_t i = 0; i < matrix.rows(); ++i) {
    const glm::dvec2 own = in_double(x[i]);
    glm::dvec2 sum(0);
    for (const auto& entry : matrix.lower.row(i)) {
      const glm::dvec2 flow = factor * entry.value * (in_double(x[entry.column]) - own);
      sum += flow;
      load[entry.column] += flow;
    }
    load[i] -= sum;
  }
}

template <class Real>
double inner(const std::vector<glm::vec<2, Real>>& a, const std::vector<glm::vec<2, Real>>& b) {
  glm::dvec2 sum(0);
  for (std::size_t i = 0; i < a.size(); ++i) sum += glm::dvec2(a[i]) * glm::dvec2(b[i]);
  return sum.x + sum.y;
}

}  // namespace

template <class Real>
bool MultigridLevels<Real>::build(GraphLaplacian<Real>& matrix) {
  if (levels_.empty()) levels_.resize(1);
  std::swap(levels_[0].matrix, matrix);
  const bool large = levels_[0].matrix.rows() > large_system;
  if (large) matrix = {};
  const bool built = build_levels();
  if (large) coarsening_ = {};
  if (built) make_room();
  return built;
}

template <class Real>
bool MultigridLevels<Real>::build_levels() {
  for (depth_ = 0;; ++depth_) {
    if (levels_.size() < depth_ + 2) levels_.resize(depth_ + 2);
    Level& level = levels_[depth_];
    const std::size_t n = level.matrix.rows();
    if (n <= direct_limit) break;
    if (!coarsening_.run(level.matrix, level.inverse_diagonal, level.prolongation,
                         levels_[depth_ + 1].matrix)) {
      return false;
    }
  }
  return true;
}

template <class Real>
void MultigridLevels<Real>::make_room() {
  for (std::size_t depth = 0; depth <= depth_; ++depth) {
    const std::size_t n = levels_[depth].matrix.rows();
    for (Vector* v : {&levels_[depth].x, &levels_[depth].load, &levels_[depth].rest}) v->resize(n);
  }
  factorize_coarsest();
}

template <class Real>
void MultigridLevels<Real>::factorize_coarsest() {
  const GraphLaplacian<Real>& graph = levels_[depth_].matrix;
  SymmetricMatrix matrix;
  matrix.first.push_back(0);
  matrix.diagonal.resize(graph.rows());
  for (std::size_t i = 0; i < graph.rows(); ++i) {
    graph.each_of_row(i, [&](const auto& entry) {
      matrix.column.push_back(entry.column);
      matrix.value.push_back(entry.value);
      matrix.diagonal[i] -= entry.value;
    });
    matrix.first.push_back(static_cast<std::uint32_t>(matrix.column.size()));
  }
  coarsest_.factorize(matrix);
}

template <class Real>
void MultigridLevels<Real>::solve_coarsest(Level& level) {
  coarse_load_.assign(level.load.begin(), level.load.end());
  coarse_x_.resize(level.x.size());
  coarsest_.solve(coarse_load_, coarse_x_);
  for (std::size_t i = 0; i < level.x.size(); ++i) {
    level.x[i] = glm::vec<2, Real>(coarse_x_[i]);
  }
}

// A forward Gauss-Seidel sweep that starts from 0 meets only zeros above the diagonal, and leaves
// only that part in the residual. Row i's part of it is known as soon as its x is.
template <class Real>
void MultigridLevels<Real>::smooth_down(std::size_t depth) {
  Level& level = levels_[depth];
  const auto n = static_cast<std::uint32_t>(level.matrix.rows());
  const auto* entries = level.matrix.lower.entries.data();
  const std::uint32_t* first = level.matrix.lower.first.data();
  const Real* inverse_diagonal = level.inverse_diagonal.data();
  const PairOf<Real>* load = pairs<Real>(level.load);
  PairOf<Real>*x = pairs<Real>(level.x), *rest = pairs<Real>(level.rest);
  for (std::uint32_t i = 0; i < n; ++i) {
    PairOf<Real> sum = load[i];
    for (std::uint32_t k = first[i]; k < first[i + 1]; ++k) {
      sum -= entries[k].value * x[entries[k].column];
    }
    x[i] = sum *= inverse_diagonal[i];
    rest[i] = PairOf<Real>{};
    for (std::uint32_t k = first[i]; k < first[i + 1]; ++k) {
      rest[entries[k].column] -= entries[k].value * sum;
    }
  }
}

// The residual becomes the load of the next level.
template <class Real>
void MultigridLevels<Real>::restrict_rest(std::size_t depth) {
  Level& level = levels_[depth];
  const auto n = static_cast<std::uint32_t>(level.matrix.rows());
  const auto* entries = level.prolongation.entries.data();
  const std::uint32_t* first = level.prolongation.first.data();
  const PairOf<Real>* rest = pairs<Real>(level.rest);
  std::fill(levels_[depth + 1].load.begin(), levels_[depth + 1].load.end(), glm::vec<2, Real>(0));
  PairOf<Real>* load = pairs<Real>(levels_[depth + 1].load);
  for (std::uint32_t i = 0; i < n; ++i) {
    const PairOf<Real> own = rest[i];
    for (std::uint32_t k = first[i]; k < first[i + 1]; ++k) {
      load[entries[k].column] += entries[k].value * own;
    }
  }
}

// Adds the next level's solution. A backward sweep then makes the cycle symmetric.
template <class Real>
void MultigridLevels<Real>::smooth_up(std::size_t depth) {
  Level& level = levels_[depth];
  const auto n = static_cast<std::uint32_t>(level.matrix.rows());
  const auto *entries = level.matrix.lower.entries.data(),
             *rows = level.prolongation.entries.data();
  const std::uint32_t *first = level.matrix.lower.first.data(),
                      *row_first = level.prolongation.first.data();
  const Real* inverse_diagonal = level.inverse_diagonal.data();
  const PairOf<Real>*load = pairs<Real>(level.load), *coarse_x = pairs<Real>(levels_[depth + 1].x);
  PairOf<Real>*x = pairs<Real>(level.x), *rest = pairs<Real>(level.rest);
  for (std::uint32_t i = 0; i < n; ++i) {
    PairOf<Real> sum = x[i];
    for (std::uint32_t k = row_first[i]; k < row_first[i + 1]; ++k) {
      sum += rows[k].value * coarse_x[rows[k].column];
    }
    x[i] = sum;
    rest[i] = load[i];
  }
  for (std::uint32_t i = n; i-- > 0;) {
    // The part below the diagonal is available at once; the part above is in `rest` by now.
    PairOf<Real> sum{};
    for (std::uint32_t k = first[i]; k < first[i + 1]; ++k) {
      sum += entries[k].value * x[entries[k].column];
    }
    x[i] = sum = (rest[i] - sum) * inverse_diagonal[i];
    for (std::uint32_t k = first[i]; k < first[i + 1]; ++k) {
      rest[entries[k].column] -= entries[k].value * sum;
    }
  }
}

// Makes x of the level an approximate solution for its load.
template <class Real>
void MultigridLevels<Real>::cycle(std::size_t depth) {
  if (depth == depth_) return solve_coarsest(levels_[depth]);
  smooth_down(depth);
  restrict_rest(depth);
  cycle(depth + 1);
  smooth_up(depth);
}

// Computes the next direction, and its product with the matrix in the finest level's rest. Returns
// the inner product of both.
template <class Real>
double MultigridLevels<Real>::step_direction(Real beta) {
  Level& level = levels_[0];
  const auto n = static_cast<std::uint32_t>(level.matrix.rows());
  const auto* entries = level.matrix.lower.entries.data();
  const std::uint32_t* first = level.matrix.lower.first.data();
  const PairOf<Real>* z = pairs<Real>(level.x);
  PairOf<Real>*direction = pairs<Real>(direction_), *product = pairs<Real>(level.rest);
  glm::dvec2 energy(0);
  for (std::uint32_t i = 0; i < n; ++i) {
    const PairOf<Real> own = z[i] + beta * direction[i];
    direction[i] = own;
    PairOf<Real> sum{}, squares{};
    for (std::uint32_t k = first[i]; k < first[i + 1]; ++k) {
      const PairOf<Real> difference = direction[entries[k].column] - own;
      const PairOf<Real> flow = entries[k].value * difference;
      sum += flow;
      squares -= flow * difference;
      product[entries[k].column] -= flow;
    }
    product[i] = sum;
    energy.x += squares[0];
    energy.y += squares[1];
  }
  return energy.x + energy.y;
}

template <class Real>
void MultigridLevels<Real>::advance(Real alpha) {
  Level& level = levels_[0];
  const std::size_t n = level.matrix.rows();
  for (std::size_t i = 0; i < n; ++i) {
    correction_[i] += alpha * direction_[i];
    level.load[i] -= alpha * level.rest[i];
  }
}

// Iterates correction_, from 0, for the finest level's load; both are in multiples of `unit`.
// Returns `again` if rounding keeps the energy from falling further, and the residual must be
// computed again.
template <class Real>
auto MultigridLevels<Real>::correct(const MultigridAccuracy& accuracy, double unit,
                                    Progress& progress) -> Outcome {
  constexpr double most = sizeof(Real) == sizeof(float) ? 1e-9 : 1e-24;
  const Vector& residual = levels_[0].load;
  std::fill(correction_.begin(), correction_.end(), glm::vec<2, Real>(0));
  std::fill(direction_.begin(), direction_.end(), glm::vec<2, Real>(0));
  double rho = 0, least = 0;
  for (int step = 0;; ++step) {
    cycle(0);
    const double now = unit * unit * inner<Real>(residual, levels_[0].x);
    if (!(now >= 0)) return Outcome::failed;  // NaN, or the cycle is not definite
    if (now <= progress.goal) return Outcome::done;
    if (progress.first) progress.goal = std::max(progress.goal, accuracy.share * now);
    progress.first = false;
    if (step == 0) least = most * now;
    if (now <= least) return Outcome::again;
    if (progress.steps_left-- == 0) return Outcome::failed;
    const double beta = step > 0 ? now / rho : 0;
    // The error falls at a steady rate. If this step will be enough, no further cycle need confirm
    // it.
    const bool last = step > 0 && now * beta <= progress.goal;
    rho = now;
    const double energy = unit * unit * step_direction(static_cast<Real>(beta));
    if (!(energy > 0)) return Outcome::failed;
    advance(static_cast<Real>(rho / energy));
    if (last) return Outcome::done;
  }
}

template <class Real>
bool MultigridLevels<Real>::solve(const MultigridAccuracy& accuracy, std::span<glm::dvec2> load,
                                  std::span<Vec2d> x) {
  Level& level = levels_[0];
  const std::size_t n = level.matrix.rows();
  direction_.resize(n);
  correction_.resize(n);
  Progress progress{accuracy.energy, accuracy.most_iterations};
  subtract_product(level.matrix, x, 1, load);
  for (;;) {
    double largest = 0;
    for (const glm::dvec2 r : load) {
      if (!std::isfinite(r.x + r.y)) return false;
      largest = std::max({largest, std::abs(r.x), std::abs(r.y)});
    }
    // Scaled to about 1 by a power of two, so that no digit is lost in single precision.
    const int exponent = largest > 0 ? std::ilogb(largest) : 0;
    const double unit = std::ldexp(1.0, exponent), shrink = std::ldexp(1.0, -exponent);
    for (std::size_t i = 0; i < n; ++i) level.load[i] = glm::vec<2, Real>(load[i] * shrink);
    const Outcome outcome = correct(accuracy, unit, progress);
    if (outcome == Outcome::failed) return false;
    for (std::size_t i = 0; i < n; ++i)
      x[i] = from_glm(to_glm(x[i]) + unit * glm::dvec2(correction_[i]));
    if (outcome == Outcome::done) return true;
    subtract_product(level.matrix, correction_, unit, load);
  }
}

template class MultigridLevels<float>;
template class MultigridLevels<double>;

bool MultigridSolver::build(const Elements& elements, const HalfEdges& half_edges,
                            std::size_t vertices) {
  const auto build = [&](auto& precision, auto& couplings) {
    build_graph<typename std::decay_t<decltype(couplings)>::value_type>(couplings, half_edges,
                                                                        vertices, precision.graph);
    give_back(couplings);
    return precision.levels.build(precision.graph);
  };
  std::vector<float> single;
  exact_ = edge_couplings(elements, half_edges, single) > most_single_coupling;
  if (!exact_) return build(single_, single);
  std::vector<double> twice;
  edge_couplings(elements, half_edges, twice);
  return build(twice_, twice);
}

bool MultigridSolver::solve(const MultigridAccuracy& accuracy, std::span<glm::dvec2> load,
                            std::span<Vec2d> x) {
  return exact_ ? twice_.levels.solve(accuracy, load, x) : single_.levels.solve(accuracy, load, x);
}

}  // namespace atlas::param
