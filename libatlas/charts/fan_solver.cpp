#include "libatlas/charts/fan_solver.h"

#include <algorithm>
#include <cmath>

#include "libatlas/core/wide_vectors.h"

namespace atlas {
namespace {

constexpr double kNoPivot = 1e-15;  // of the diagonal: rounding
// Of a triangle's area: what turns and scales by less is a mirror image, whose rotation rounding
// alone would choose.
constexpr double kNoTurn = 1e-3;

// A Pair is two neighbouring entries of a row, or a point. Pairs are read in place; a Vec2d of its
// own need not lie where they must.
static_assert(sizeof(Vec2d) == sizeof(Pair));

const Pair& pair_at(const double* from) {
  return *reinterpret_cast<const Pair*>(from);
}
Pair& pair_at(Vec2d& p) {
  return reinterpret_cast<Pair&>(p);
}
const Pair& pair_at(const Vec2d& p) {
  return reinterpret_cast<const Pair&>(p);
}

Pair quarter_turn(const Pair& p) {
  return Pair{-p[1], p[0]};
}

double sum(const Pair& p) {
  return p[0] + p[1];
}

// Products of rows a, b with c, d, over so many columns: two rows at a time, for each entry that is
// read then serves twice.
struct Products {
  double ac, ad, bc, bd;
};
Products multiply(const double* a, const double* b, const double* c, const double* d,
                  std::size_t n) {
  Pair ac{}, ad{}, bc{}, bd{};
  for (std::size_t k = 0; k < n; k += 2) {
    const Pair pa = pair_at(a + k), pb = pair_at(b + k), pc = pair_at(c + k), pd = pair_at(d + k);
    ac += pa * pc;
    ad += pa * pd;
    bc += pb * pc;
    bd += pb * pd;
  }
  return {sum(ac), sum(ad), sum(bc), sum(bd)};
}

}  // namespace

void FanSolver::factorize(const JoinedFans& joined, std::size_t vertex_count) {
  joined_ = joined;
  count_ = row_of(static_cast<std::uint32_t>(vertex_count));
  find_envelope();
  factor_.assign(row_.back(), 0);
  for (std::size_t c = 0; c < joined.cells.size(); ++c) fill(c);
  inverse_pivot_.resize(2 * first_.size());
  for (std::uint32_t p = 0; p < first_.size(); ++p) eliminate(p);
}

void FanSolver::find_envelope() {
  const std::uint32_t pairs = (count_ + 1) / 2;
  first_.resize(pairs);
  for (std::uint32_t p = 0; p < pairs; ++p) first_[p] = 2 * p;
  for (std::size_t c = 0; c < joined_.cells.size(); ++c) {
    std::uint32_t low = kNoIndex;
    for (std::uint32_t i = joined_.first[c]; i < joined_.first[c + 1]; ++i) {
      low = std::min(low, row_of(joined_.triangles[i].a));
    }
    for (std::uint32_t i = joined_.first[c]; i < joined_.first[c + 1]; ++i) {
      std::uint32_t& first = first_[row_of(joined_.triangles[i].a) / 2];
      first = std::min(first, low / 2 * 2);
    }
  }
  row_.resize(pairs + 1);
  row_[0] = 0;
  for (std::uint32_t p = 0; p < pairs; ++p) row_[p + 1] = row_[p] + 2 * (2 * p + 2 - first_[p]);
}

// Adds the stiffness of one fan without its centre.
void FanSolver::fill(std::size_t place) {
  const auto* const begin = &joined_.triangles[joined_.first[place]];
  const auto n = joined_.first[place + 1] - joined_.first[place];
  const double inverse = fans_.inverse_pivot[joined_.cells[place]];
  const auto add = [&](std::uint32_t p, std::uint32_t q, double value) {
    row(std::max(p, q))[std::min(p, q)] += p == q ? 2 * value : value;
  };
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t p = row_of(begin[i].a);
    const FanCoupling& own = fans_.coupling[begin[i].slot];
    const double scaled = own.centre * inverse;
    row(p)[p] += own.own - own.centre * scaled;
    for (std::uint32_t j = 0; j < i; ++j) {
      add(p, row_of(begin[j].a), -scaled * fans_.coupling[begin[j].slot].centre);
    }
    add(p, row_of(begin[i].b), own.next);
  }
}

// Two rows of the factor, all above done.
void FanSolver::eliminate(std::uint32_t pair) {
  const std::uint32_t i = 2 * pair;
  double *const low = row(i), *const high = row(i + 1);
  const double diagonal[2] = {low[i], high[i + 1]};
  for (std::uint32_t j = first_[pair]; j < i; j += 2) {
    const std::uint32_t begin = std::max(first_[pair], first_[j / 2]);
    const double *const c = row(j), *const d = row(j + 1);
    const Products p = multiply(low + begin, high + begin, c + begin, d + begin, j - begin);
    low[j] = (low[j] - p.ac) * inverse_pivot_[j];
    high[j] = (high[j] - p.bc) * inverse_pivot_[j];
    low[j + 1] = (low[j + 1] - p.ad - low[j] * d[j]) * inverse_pivot_[j + 1];
    high[j + 1] = (high[j + 1] - p.bd - high[j] * d[j]) * inverse_pivot_[j + 1];
  }
  const std::uint32_t begin = first_[pair];
  const Products p = multiply(low + begin, high + begin, low + begin, high + begin, i - begin);
  // Of a connected chart the last pivot is nothing but rounding: that vertex is held.
  const auto inverse = [&](double pivot, std::uint32_t at) {
    const bool held = at + 1 >= count_ || !(pivot > kNoPivot * diagonal[at - i]);
    return held ? 0 : 1 / std::sqrt(pivot);
  };
  inverse_pivot_[i] = inverse(low[i] - p.ac, i);
  high[i] = (high[i] - p.bc) * inverse_pivot_[i];
  inverse_pivot_[i + 1] = inverse(high[i + 1] - p.bd - high[i] * high[i], i + 1);
}

// The parts of a fan's maps that turn and scale: conjugate gradients times differences, times area.
// Points are complex numbers here. Returns their sum.
Vec2d FanSolver::find_turns(std::size_t place, std::span<const Vec2d> uvs) {
  const Pair centre = pair_at(uvs[place]);
  Pair whole{};
  turns_.clear();
  for (std::uint32_t i = joined_.first[place]; i < joined_.first[place + 1]; ++i) {
    const JoinedFans::Triangle& t = joined_.triangles[i];
    const Vec2d g1 = fans_.triangle[t.slot].slot_gradient;
    const Vec2d g2 = fans_.triangle[t.slot].next_gradient;
    const Pair d1 = pair_at(uvs[t.a]) - centre, d2 = pair_at(uvs[t.b]) - centre;
    const Pair turn = g1.x * d1 + g2.x * d2 - quarter_turn(g1.y * d1 + g2.y * d2);
    turns_.push_back({turn[0], turn[1]});
    whole += turn;
  }
  return {whole[0], whole[1]};
}

// What the rotations nearest to a fan's maps ask of its vertices.
void FanSolver::load_fan(std::size_t place, std::span<const Vec2d> uvs) {
  const auto begin = joined_.first[place], end = joined_.first[place + 1];
  const Vec2d turns = find_turns(place, uvs);
  const Pair whole{turns.x, turns.y};
  Pair centre_load{};
  for (std::uint32_t i = begin; i < end; ++i) {
    const JoinedFans::Triangle& t = joined_.triangles[i];
    const FanTriangle& fan = fans_.triangle[t.slot];
    Pair turn = pair_at(turns_[i - begin]);
    double squared = turn[0] * turn[0] + turn[1] * turn[1];
    if (squared <= kNoTurn * kNoTurn * fan.area * fan.area) {
      turn = whole;
      squared = turn[0] * turn[0] + turn[1] * turn[1];
    }
    const Pair r = squared > 0 ? turn * (1 / std::sqrt(squared)) : Pair{1, 0};
    const Pair across = quarter_turn(r);
    const Vec2d g1 = fan.slot_gradient, g2 = fan.next_gradient;
    const Pair a = g1.x * r + g1.y * across, b = g2.x * r + g2.y * across;
    pair_at(load_[row_of(t.a)]) += a;
    pair_at(load_[row_of(t.b)]) += b;
    centre_load -= a + b;
  }
  centre_load *= fans_.inverse_pivot[joined_.cells[place]];
  for (std::uint32_t i = begin; i < end; ++i) {
    const JoinedFans::Triangle& t = joined_.triangles[i];
    pair_at(load_[row_of(t.a)]) -= fans_.coupling[t.slot].centre * centre_load;
  }
  pair_at(centre_load_[place]) = centre_load;
}

namespace {

// Two rows of a factor, from column 0 on, of which the envelope holds those from `first` to `end`.
struct RowPair {
  const double *low, *high;
  std::uint32_t first, end;
};

// x and y less what the rows say of the points before.
void subtract_known_narrow(const RowPair& row, const Vec2d* points, Pair& x, Pair& y) {
  Pair more_x{}, more_y{};
  for (std::uint32_t k = row.first; k < row.end; k += 2) {
    const Pair p = pair_at(points[k]), q = pair_at(points[k + 1]);
    x -= row.low[k] * p;
    y -= row.high[k] * p;
    more_x += row.low[k + 1] * q;
    more_y += row.high[k + 1] * q;
  }
  x -= more_x;
  y -= more_y;
}

ATLAS_WIDE void subtract_known_wide(const RowPair& row, const Vec2d* points, Pair& x, Pair& y) {
  Quad xs{x[0], x[1], 0, 0}, ys{y[0], y[1], 0, 0};
  for (std::uint32_t k = row.first; k < row.end; k += 2) {
    // Of four entries, two beyond those that count: the diagonal's lie there.
    const Quad low = *reinterpret_cast<const QuadInPlace*>(row.low + k);
    const Quad high = *reinterpret_cast<const QuadInPlace*>(row.high + k);
    const Quad both = *reinterpret_cast<const QuadInPlace*>(points + k);
    xs -= __builtin_shufflevector(low, low, 0, 0, 1, 1) * both;
    ys -= __builtin_shufflevector(high, high, 0, 0, 1, 1) * both;
  }
  x = Pair{xs[0] + xs[2], xs[1] + xs[3]};
  y = Pair{ys[0] + ys[2], ys[1] + ys[3]};
}

// The points before less what x and y add to them.
void subtract_from_known_narrow(const RowPair& row, const Pair& x, const Pair& y, Vec2d* points) {
  for (std::uint32_t k = row.first; k < row.end; ++k) {
    pair_at(points[k]) -= row.low[k] * x + row.high[k] * y;
  }
}

ATLAS_WIDE void subtract_from_known_wide(const RowPair& row, const Pair& x, const Pair& y,
                                         Vec2d* points) {
  const Quad xs{x[0], x[1], x[0], x[1]}, ys{y[0], y[1], y[0], y[1]};
  for (std::uint32_t k = row.first; k < row.end; k += 2) {
    const Quad low = *reinterpret_cast<const QuadInPlace*>(row.low + k);
    const Quad high = *reinterpret_cast<const QuadInPlace*>(row.high + k);
    *reinterpret_cast<QuadInPlace*>(points + k) -=
        __builtin_shufflevector(low, low, 0, 0, 1, 1) * xs +
        __builtin_shufflevector(high, high, 0, 0, 1, 1) * ys;
  }
}

}  // namespace

void FanSolver::solve() {
  const auto n = static_cast<std::uint32_t>(2 * first_.size());
  const auto subtract_known = has_wide_vectors ? subtract_known_wide : subtract_known_narrow;
  const auto subtract_from_known =
      has_wide_vectors ? subtract_from_known_wide : subtract_from_known_narrow;
  for (std::uint32_t i = 0; i < n; i += 2) {
    const RowPair both{row(i), row(i + 1), first_[i / 2], i};
    Pair x = pair_at(load_[i]), y = pair_at(load_[i + 1]);
    subtract_known(both, load_.data(), x, y);
    x *= inverse_pivot_[i];
    y = (y - both.high[i] * x) * inverse_pivot_[i + 1];
    pair_at(load_[i]) = x;
    pair_at(load_[i + 1]) = y;
  }
  for (std::uint32_t i = n; i > 0;) {
    i -= 2;
    const RowPair both{row(i), row(i + 1), first_[i / 2], i};
    const Pair y = pair_at(load_[i + 1]) * inverse_pivot_[i + 1];
    const Pair x = (pair_at(load_[i]) - both.high[i] * y) * inverse_pivot_[i];
    pair_at(load_[i]) = x;
    pair_at(load_[i + 1]) = y;
    subtract_from_known(both, x, y, load_.data());
  }
}

void FanSolver::step(double relaxation, std::span<Vec2d> uvs) {
  const std::size_t cells = joined_.cells.size();
  load_.assign(2 * first_.size(), Vec2d{});
  centre_load_.resize(cells);
  for (std::size_t c = 0; c < cells; ++c) load_fan(c, uvs);
  solve();
  for (std::size_t i = 0; i < count_; ++i) {
    Pair& uv = pair_at(uvs[cells + i]);
    uv += relaxation * (pair_at(load_[i]) - uv);
  }
  for (std::size_t c = 0; c < cells; ++c) {
    Pair sum{};
    for (std::uint32_t i = joined_.first[c]; i < joined_.first[c + 1]; ++i) {
      const JoinedFans::Triangle& t = joined_.triangles[i];
      sum += fans_.coupling[t.slot].centre * pair_at(uvs[t.a]);
    }
    const double inverse = fans_.inverse_pivot[joined_.cells[c]];
    pair_at(uvs[c]) = pair_at(centre_load_[c]) - inverse * sum;
  }
}

}  // namespace atlas
