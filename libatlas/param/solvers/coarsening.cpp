#include "libatlas/param/solvers/coarsening.h"

#include <algorithm>
#include <cmath>

#include "libatlas/core/no_index.h"

namespace atlas::param {
namespace {

constexpr double strong_coupling = 0.06;  // relative to the geometric mean of the two diagonals
// The factor of couplings between groups, for groups of one row. Groups are as far apart as the
// square root of their size, and a function that is linear there should have as much energy as in
// the finer matrix. Values between 0.8 and 1 make little difference (measured).
constexpr double group_coupling = 0.9;
// The most steps along lists of couplings per entry of the matrix; charts take about five.
constexpr std::size_t most_steps = 100;

}  // namespace

template <class Real>
bool Coarsening<Real>::run(GraphLaplacian<Real>& a, std::vector<Real>& inverse_diagonal,
                           GraphRows<Real>& prolongation, GraphLaplacian<Real>& coarse) {
  measure_diagonal(a, inverse_diagonal);
  groups_ = aggregate(a);
  if (groups_ > a.rows() / 2) return false;
  prolongate(a, prolongation);
  if (a.rows() > large_system) a.upper = {};
  if (!couple_groups(a)) return false;
  gather(coarse);
  return true;
}

template <class Real>
void Coarsening<Real>::measure_diagonal(const GraphLaplacian<Real>& a,
                                        std::vector<Real>& inverse_diagonal) {
  const std::size_t n = a.rows();
  strength_.resize(n);
  inverse_diagonal.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    Real sum = 0;
    a.each_of_row(i, [&](const auto& entry) { sum -= entry.value; });
    inverse_diagonal[i] = sum > 0 ? 1 / sum : 0;
    strength_[i] = static_cast<float>(std::sqrt(strong_coupling * std::max<Real>(sum, 0)));
  }
}

// Assigns every row to a group. Returns the number of groups.
template <class Real>
std::uint32_t Coarsening<Real>::aggregate(const GraphLaplacian<Real>& a) {
  const auto n = static_cast<std::uint32_t>(a.rows());
  group_.assign(n, kNoIndex);
  const auto strong = [&](std::uint32_t i, const auto& entry) {
    return -entry.value > strength_[i] * strength_[entry.column];
  };
  std::uint32_t count = 0;
  // First, whole neighbourhoods become groups.
  for (std::uint32_t i = 0; i < n; ++i) {
    if (group_[i] != kNoIndex) continue;
    const auto taken = [&](const auto& entry) {
      return group_[entry.column] != kNoIndex && strong(i, entry);
    };
    const auto lower = a.lower.row(i), upper = a.upper.row(i);
    if (std::any_of(lower.begin(), lower.end(), taken)) continue;
    if (std::any_of(upper.begin(), upper.end(), taken)) continue;
    group_[i] = count;
    a.each_of_row(i, [&](const auto& entry) {
      if (strong(i, entry)) group_[entry.column] = count;
    });
    ++count;
  }
  // Then, each remaining row joins the neighbour that it is most strongly coupled to.
  join_.assign(n, kNoIndex);
  for (std::uint32_t i = 0; i < n; ++i) {
    if (group_[i] != kNoIndex) continue;
    Real least = 0;
    a.each_of_row(i, [&](const auto& entry) {
      if (group_[entry.column] == kNoIndex || entry.value >= least) return;
      least = entry.value;
      join_[i] = group_[entry.column];
    });
  }
  // Rows without such a neighbour become groups of their own.
  for (std::uint32_t i = 0; i < n; ++i) {
    if (group_[i] == kNoIndex) group_[i] = join_[i] != kNoIndex ? join_[i] : count++;
  }
  return count;
}

// Computes the rows of P = (I - omega D^-1 A) P0, where P0 has a one at each row's group.
template <class Real>
void Coarsening<Real>::prolongate(const GraphLaplacian<Real>& a, GraphRows<Real>& out) {
  const auto n = static_cast<std::uint32_t>(a.rows());
  out.first.resize(n + 1);
  out.entries.clear();
  // A row has about three entries, and as many edges.
  out.entries.reserve(n + a.lower.entries.size());
  place_.assign(groups_, 0);
  for (std::uint32_t i = 0; i < n; ++i) {
    const auto begin = static_cast<std::uint32_t>(out.entries.size());
    out.first[i] = begin;
    // Where couplings have both signs, half the row's absolute sum is an upper bound on the
    // diagonal.
    Real sum = 0, absolute = 0;
    a.each_of_row(i, [&](const auto& entry) {
      sum -= entry.value;
      absolute += std::abs(entry.value);
    });
    const Real bound = sum + absolute;
    const Real damping = bound > 0 ? Real(4.0 / 3.0) / bound : 0;
    // The row's own coefficient makes its sum one, so constants stay constant.
    out.entries.push_back({group_[i], 1 - damping * sum});
    place_[group_[i]] = begin;
    a.each_of_row(i, [&](const auto& entry) {
      const std::uint32_t group = group_[entry.column];
      std::uint32_t& at = place_[group];
      const auto end = static_cast<std::uint32_t>(out.entries.size());
      if (at < begin || at >= end || out.entries[at].column != group) {
        at = end;
        out.entries.push_back({group, 0});
      }
      out.entries[at].value -= damping * entry.value;
    });
  }
  out.first[n] = static_cast<std::uint32_t>(out.entries.size());
}

// Sums the couplings between groups. Returns false if there are too many.
template <class Real>
bool Coarsening<Real>::couple_groups(const GraphLaplacian<Real>& a) {
  const std::size_t most_couplings = a.lower.entries.size();
  const std::size_t limit = most_steps * (most_couplings + a.rows());
  std::size_t steps = 0;
  head_.assign(groups_, kNoIndex);
  size_.assign(groups_, 0);
  couplings_.clear();
  for (std::uint32_t i = 0; i < a.rows(); ++i) {
    const std::uint32_t own = group_[i];
    ++size_[own];
    for (const auto& entry : a.lower.row(i)) {
      const std::uint32_t other = group_[entry.column];
      if (other == own) continue;
      steps += couple(std::max(own, other), std::min(own, other), entry.value);
    }
    if (couplings_.size() > most_couplings || steps > limit) return false;
  }
  return true;
}

// Returns the number of steps taken.
template <class Real>
std::size_t Coarsening<Real>::couple(std::uint32_t row, std::uint32_t column, double value) {
  std::size_t steps = 1;
  for (std::uint32_t k = head_[row]; k != kNoIndex; k = couplings_[k].next, ++steps) {
    if (couplings_[k].column != column) continue;
    couplings_[k].value += value;
    return steps;
  }
  couplings_.push_back({column, head_[row], value});
  head_[row] = static_cast<std::uint32_t>(couplings_.size() - 1);
  return steps;
}

template <class Real>
void Coarsening<Real>::gather(GraphLaplacian<Real>& coarse) const {
  const auto each = [&](auto&& body) {
    for (std::uint32_t row = 0; row < groups_; ++row) {
      for (std::uint32_t k = head_[row]; k != kNoIndex; k = couplings_[k].next) {
        const std::uint32_t column = couplings_[k].column;
        const double factor = group_coupling / std::sqrt(0.5 * (size_[row] + size_[column]));
        body(row, column, static_cast<Real>(factor * couplings_[k].value));
      }
    }
  };
  gather_edges(groups_, each, coarse);
}

template class Coarsening<float>;
template class Coarsening<double>;

}  // namespace atlas::param
