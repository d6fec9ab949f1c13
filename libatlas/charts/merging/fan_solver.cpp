#include "libatlas/charts/merging/fan_solver.h"

#include <algorithm>
#include <cmath>

#include "libatlas/charts/merging/fan_kernels.h"

namespace atlas {
namespace {

// Pivots below this share of the diagonal are mere rounding.
constexpr double kNoPivot = 1e-15;
// If the part of a triangle's map that turns and scales is smaller than this share of its area, the
// map is a mirror image, and mere rounding would choose its rotation.
constexpr double kNoTurn = 1e-3;
// The centres of fans with more slots stay in the factor. Without its centre, every slot of a fan
// is joined to every other one: trials of discs with 8000 teeth took up to ten seconds each.
constexpr std::uint32_t kWideFan = 64;

ATLAS_INLINE Pair lower_half(const Quad& q) {
  return __builtin_shufflevector(q, q, 0, 1);
}
ATLAS_INLINE Pair upper_half(const Quad& q) {
  return __builtin_shufflevector(q, q, 2, 3);
}

}  // namespace

// The factor, addressed as if each row began with column 0.
struct FanSolver::Factor {
  const std::uint32_t* first;
  const std::size_t* begin;
  double *values, *inverse_pivot;
  std::uint32_t pairs;
  std::uint32_t count;  // number of rows; the last one is held

  ATLAS_INLINE double* blocks(std::uint32_t pair) const {
    return values + begin[pair] - 2 * std::size_t{first[pair]};
  }
};

// The current fan. Values are stored as arrays, so that four of them can be processed at a time.
struct FanSolver::Fan {
  const JoinedFans::Triangle* triangles;
  std::uint32_t count;
  const double *g1x, *g1y, *g2x, *g2y, *area;
  double *turn_x, *turn_y, *squared;  // turning and scaling part of the maps, times area
  Vec2d* loads;                       // of each triangle, on its slot and on the next
};

struct FanSolver::Kernels {
  // Products of the two rows of `own` with those of `other`, over a range of columns.
  struct Products {
    Quad upper, lower;  // with the upper and the lower row of `other`; each sum is in two parts
  };
  ATLAS_INLINE static Products multiply(const double* own, const double* other, std::uint32_t begin,
                                        std::uint32_t end) {
    Quad upper{}, lower{};
    for (std::uint32_t k = 2 * begin; k < 2 * end; k += 4) {
      const Quad both = QuadAt(own + k).quad;
      const Pair c = pair_at(other + k), d = pair_at(other + k + 2);
      upper += both * __builtin_shufflevector(c, c, 0, 1, 0, 1);
      lower += both * __builtin_shufflevector(d, d, 0, 1, 0, 1);
    }
    return {upper, lower};
  }

  // Computes two rows of the factor, when all rows above are done.
  ATLAS_INLINE static void eliminate(const Factor& factor, std::uint32_t pair) {
    const std::uint32_t i = 2 * pair, begin = factor.first[pair];
    double *const own = factor.blocks(pair), *const inverse = factor.inverse_pivot;
    for (std::uint32_t j = begin; j < i; j += 2) {
      const double* const other = factor.blocks(j / 2);
      const Products p = multiply(own, other, std::max(begin, factor.first[j / 2]), j);
      const Quad rest =
          QuadAt(own + 2 * j).quad - (__builtin_shufflevector(p.upper, p.lower, 0, 4, 2, 6) +
                                      __builtin_shufflevector(p.upper, p.lower, 1, 5, 3, 7));
      const Quad even = __builtin_shufflevector(rest, rest, 0, 0, 2, 2) * inverse[j];
      const Quad odd = (rest - even * other[2 * j + 2]) * inverse[j + 1];
      put_quad(own + 2 * j, __builtin_shufflevector(even, odd, 0, 5, 2, 7));
    }
    const Products p = multiply(own, own, begin, i);
    double* const corner = own + 2 * i;
    // In a connected chart the last pivot is mere rounding, so that vertex is held.
    const auto invert = [&](double pivot, double diagonal, std::uint32_t at) {
      const bool held = at + 1 >= factor.count || !(pivot > kNoPivot * diagonal);
      return held ? 0 : 1 / std::sqrt(pivot);
    };
    inverse[i] = invert(corner[0] - (p.upper[0] + p.upper[1]), corner[0], i);
    corner[2] = (corner[2] - (p.upper[2] + p.upper[3])) * inverse[i];
    const double last = corner[3] - (p.lower[2] + p.lower[3]) - corner[2] * corner[2];
    inverse[i + 1] = invert(last, corner[3], i + 1);
  }

  ATLAS_INLINE static void eliminate_all(const Factor& factor) {
    for (std::uint32_t p = 0; p < factor.pairs; ++p) eliminate(factor, p);
  }
  ATLAS_WIDE static void eliminate_wide(const Factor& factor) { eliminate_all(factor); }
  static void eliminate_narrow(const Factor& factor) { eliminate_all(factor); }

  ATLAS_INLINE static void solve(const Factor& factor, Vec2d* load) {
    for (std::uint32_t p = 0; p < factor.pairs; ++p) {
      const double* const own = factor.blocks(p);
      const double* const inverse = factor.inverse_pivot + 2 * p;
      Pair x = pair_at(load[2 * p]), y = pair_at(load[2 * p + 1]);
      Quad xs{x[0], x[1], 0, 0}, ys{y[0], y[1], 0, 0};
      for (std::uint32_t k = factor.first[p]; k < 2 * p; k += 2) {
        const Quad block = QuadAt(own + 2 * k).quad, points = QuadAt(&load[k].x).quad;
        xs -= __builtin_shufflevector(block, block, 0, 0, 1, 1) * points;
        ys -= __builtin_shufflevector(block, block, 2, 2, 3, 3) * points;
      }
      x = (lower_half(xs) + upper_half(xs)) * inverse[0];
      y = (lower_half(ys) + upper_half(ys) - own[4 * p + 2] * x) * inverse[1];
      // Both are written at once, since they are read at once: processors stall where one read
      // needs the results of two writes.
      put_quad(&load[2 * p].x, __builtin_shufflevector(x, y, 0, 1, 2, 3));
    }
    for (std::uint32_t p = factor.pairs; p-- > 0;) {
      const double* const own = factor.blocks(p);
      const double* const inverse = factor.inverse_pivot + 2 * p;
      const Pair y = pair_at(load[2 * p + 1]) * inverse[1];
      const Pair x = (pair_at(load[2 * p]) - own[4 * p + 2] * y) * inverse[0];
      pair_at(load[2 * p]) = x;
      pair_at(load[2 * p + 1]) = y;
      const Quad xs = __builtin_shufflevector(x, x, 0, 1, 0, 1),
                 ys = __builtin_shufflevector(y, y, 0, 1, 0, 1);
      for (std::uint32_t k = factor.first[p]; k < 2 * p; k += 2) {
        const Quad block = QuadAt(own + 2 * k).quad;
        put_quad(&load[k].x, QuadAt(&load[k].x).quad -
                                 (__builtin_shufflevector(block, block, 0, 0, 1, 1) * xs +
                                  __builtin_shufflevector(block, block, 2, 2, 3, 3) * ys));
      }
    }
  }

  // Gives triangles without a clear rotation the rotation of the whole fan.
  static void mend_turns(const Fan& fan) {
    double x = 0, y = 0;
    for (std::uint32_t i = 0; i < fan.count; ++i) {
      x += fan.turn_x[i];
      y += fan.turn_y[i];
    }
    for (std::uint32_t i = 0; i < fan.count; ++i) {
      if (fan.squared[i] <= kNoTurn * kNoTurn * fan.area[i] * fan.area[i]) {
        fan.turn_x[i] = x;
        fan.turn_y[i] = y;
        fan.squared[i] = x * x + y * y;
      }
      if (fan.squared[i] > 0) continue;
      fan.turn_x[i] = fan.squared[i] = 1;
      fan.turn_y[i] = 0;
    }
  }

  // Finds the parts of a fan's maps that turn and scale, times area: conjugate gradients times
  // differences, where points are complex numbers.
  ATLAS_INLINE static void find_turns(const Fan& fan, const Vec2d* uvs) {
    const Vec2d centre = uvs[fan.triangles->centre];
    auto clear = Quad{} == Quad{};
    for (std::uint32_t i = 0; i < fan.count; i += 4) {
      const Quad g1x = QuadAt(fan.g1x + i).quad, g1y = QuadAt(fan.g1y + i).quad;
      const Quad g2x = QuadAt(fan.g2x + i).quad, g2y = QuadAt(fan.g2y + i).quad;
      Sides d;
      find_sides(fan.triangles + i, uvs, centre, d);
      const Quad x = (g1x * d.ax + g2x * d.bx) + (g1y * d.ay + g2y * d.by);
      const Quad y = (g1x * d.ay + g2x * d.by) - (g1y * d.ax + g2y * d.bx);
      const Quad squared = x * x + y * y, area = QuadAt(fan.area + i).quad;
      put_quad(fan.turn_x + i, x);
      put_quad(fan.turn_y + i, y);
      put_quad(fan.squared + i, squared);
      clear &= squared > kNoTurn * kNoTurn * area * area;
    }
    if (!(clear[0] & clear[1] & clear[2] & clear[3])) mend_turns(fan);
  }

  // Finds the loads on a fan's vertices for the rotations nearest to its maps.
  ATLAS_INLINE static void find_loads(const Fan& fan) {
    for (std::uint32_t i = 0; i < fan.count; i += 4) {
      Quad root = QuadAt(fan.squared + i).quad;
      take_root(root);
      const Quad inverse = 1 / root;
      const Quad c = QuadAt(fan.turn_x + i).quad * inverse,
                 s = QuadAt(fan.turn_y + i).quad * inverse;
      const Quad g1x = QuadAt(fan.g1x + i).quad, g1y = QuadAt(fan.g1y + i).quad;
      const Quad g2x = QuadAt(fan.g2x + i).quad, g2y = QuadAt(fan.g2y + i).quad;
      const Quad ax = g1x * c - g1y * s, ay = g1x * s + g1y * c;
      const Quad bx = g2x * c - g2y * s, by = g2x * s + g2y * c;
      double* const out = &fan.loads[2 * i].x;
      // Of triangles 0 and 2, and of 1 and 3.
      const Quad a02 = __builtin_shufflevector(ax, ay, 0, 4, 2, 6),
                 a13 = __builtin_shufflevector(ax, ay, 1, 5, 3, 7);
      const Quad b02 = __builtin_shufflevector(bx, by, 0, 4, 2, 6),
                 b13 = __builtin_shufflevector(bx, by, 1, 5, 3, 7);
      put_quad(out, __builtin_shufflevector(a02, b02, 0, 1, 4, 5));
      put_quad(out + 4, __builtin_shufflevector(a13, b13, 0, 1, 4, 5));
      put_quad(out + 8, __builtin_shufflevector(a02, b02, 2, 3, 6, 7));
      put_quad(out + 12, __builtin_shufflevector(a13, b13, 2, 3, 6, 7));
    }
  }

  ATLAS_INLINE static void load_fans(FanSolver& solver, const Vec2d* uvs) {
    const JoinedFans& joined = solver.joined_;
    const Fans& fans = solver.fans_;
    Fan fan = solver.scratch_fan();
    Vec2d* const load = solver.load_.data();
    for (std::uint32_t c = 0; c < joined.cells.size(); ++c) {
      fan.triangles = joined.triangles.data() + joined.first[c];
      fan.count = joined.first[c + 1] - joined.first[c];
      if (fan.count == 0) continue;
      const std::size_t slot = fan.triangles->slot;
      fan.g1x = fans.slot_gradient_x.data() + slot;
      fan.g1y = fans.slot_gradient_y.data() + slot;
      fan.g2x = fans.next_gradient_x.data() + slot;
      fan.g2y = fans.next_gradient_y.data() + slot;
      fan.area = fans.area.data() + slot;
      find_turns(fan, uvs);
      find_loads(fan);
      Pair centre{}, before{};
      for (std::uint32_t i = 0; i < fan.count; ++i) {
        const Pair a = pair_at(fan.loads[2 * i]), b = pair_at(fan.loads[2 * i + 1]);
        Pair& own = pair_at(load[fan.triangles[i].a]);
        own = i == 0 ? own + a : own + before + a;
        centre -= a + b;
        before = b;
      }
      pair_at(load[fan.triangles->a]) += before;
      const std::uint32_t row = solver.centre_row_[c];
      if (row != kNoIndex) pair_at(load[joined.cells.size() + row]) = centre;
      centre *= fans.inverse_pivot[joined.cells[c]];
      pair_at(load[c]) = centre;
      if (row != kNoIndex) continue;
      const FanCoupling* const coupling = fans.coupling.data() + slot;
      for (std::uint32_t i = 0; i < fan.count; ++i) {
        pair_at(load[fan.triangles[i].a]) -= coupling[i].centre * centre;
      }
    }
  }

  ATLAS_INLINE static void place_centres(const FanSolver& solver, Vec2d* uvs) {
    const JoinedFans& joined = solver.joined_;
    for (std::uint32_t c = 0; c < joined.cells.size(); ++c) {
      Pair sum{};
      for (std::uint32_t i = joined.first[c]; i < joined.first[c + 1]; ++i) {
        const JoinedFans::Triangle& t = joined.triangles[i];
        sum += solver.fans_.coupling[t.slot].centre * pair_at(uvs[t.a]);
      }
      const double inverse = solver.fans_.inverse_pivot[joined.cells[c]];
      pair_at(uvs[c]) = pair_at(solver.load_[c]) - inverse * sum;
    }
  }

  ATLAS_INLINE static void step(FanSolver& solver, double relaxation, Vec2d* uvs) {
    load_fans(solver, uvs);
    Vec2d* const load = solver.load_.data() + solver.joined_.cells.size();
    solve(solver.factor(), load);
    Vec2d* const rows = uvs + solver.joined_.cells.size();
    for (std::uint32_t i = 0; i < solver.vertex_rows_; ++i) {
      Pair& uv = pair_at(rows[i]);
      uv += relaxation * (pair_at(load[i]) - uv);
    }
    place_centres(solver, uvs);
  }
  ATLAS_WIDE static void step_wide(FanSolver& solver, double relaxation, Vec2d* uvs) {
    step(solver, relaxation, uvs);
  }
  static void step_narrow(FanSolver& solver, double relaxation, Vec2d* uvs) {
    step(solver, relaxation, uvs);
  }
};

FanSolver::Factor FanSolver::factor() {
  return {first_.data(),
          row_.data(),
          factor_.data(),
          inverse_pivot_.data(),
          static_cast<std::uint32_t>(first_.size()),
          count_};
}

FanSolver::Fan FanSolver::scratch_fan() {
  double* const scratch = scratch_.data();
  const std::size_t n = longest_;
  Fan fan;
  fan.turn_x = scratch;
  fan.turn_y = scratch + n;
  fan.squared = scratch + 2 * n;
  fan.loads = reinterpret_cast<Vec2d*>(scratch + 3 * n);
  return fan;
}

void FanSolver::factorize(const JoinedFans& joined, std::size_t vertex_count) {
  joined_ = joined;
  vertex_rows_ = count_ = row_of(static_cast<std::uint32_t>(vertex_count));
  centre_row_.clear();
  for (std::size_t c = 0; c < joined.cells.size(); ++c) {
    const bool wide = joined.first[c + 1] - joined.first[c] > kWideFan;
    centre_row_.push_back(wide ? count_++ : kNoIndex);
  }
  find_envelope();
  factor_.assign(row_.back(), 0);
  rows_.resize(longest_);
  columns_.resize(longest_);
  for (std::size_t c = 0; c < joined.cells.size(); ++c) fill(c);
  inverse_pivot_.resize(2 * first_.size());
  scratch_.resize(7 * longest_);
  (has_wide_vectors ? Kernels::eliminate_wide : Kernels::eliminate_narrow)(factor());
}

void FanSolver::find_envelope() {
  const std::uint32_t pairs = (count_ + 1) / 2;
  first_.resize(pairs);
  for (std::uint32_t p = 0; p < pairs; ++p) first_[p] = 2 * p;
  const auto reach = [&](std::uint32_t row, std::uint32_t low) {
    first_[row / 2] = std::min(first_[row / 2], low / 2 * 2);
  };
  std::uint32_t longest = 0;
  for (std::size_t c = 0; c < joined_.cells.size(); ++c) {
    const std::uint32_t begin = joined_.first[c], end = joined_.first[c + 1];
    std::uint32_t low = kNoIndex;
    for (std::uint32_t i = begin; i < end; ++i) low = std::min(low, row_of(joined_.triangles[i].a));
    const std::uint32_t centre = centre_row_[c];
    if (centre != kNoIndex) reach(centre, low);
    for (std::uint32_t i = begin; i < end; ++i) {
      const std::uint32_t a = row_of(joined_.triangles[i].a), b = row_of(joined_.triangles[i].b);
      reach(std::max(a, b), centre != kNoIndex ? std::min(a, b) : low);
      if (centre == kNoIndex) reach(a, low);
    }
    longest = std::max(longest, end - begin);
  }
  longest_ = (longest + 3) / 4 * 4;
  row_.resize(pairs + 1);
  row_[0] = 0;
  for (std::uint32_t p = 0; p < pairs; ++p) row_[p + 1] = row_[p] + 2 * (2 * p + 2 - first_[p]);
}

// Adds the stiffness of one fan, with its centre eliminated unless that has a row.
void FanSolver::fill(std::size_t place) {
  const auto* const fan = &joined_.triangles[joined_.first[place]];
  const auto n = joined_.first[place + 1] - joined_.first[place];
  if (n == 0) return;
  const double inverse = fans_.inverse_pivot[joined_.cells[place]];
  const FanCoupling* const coupling = &fans_.coupling[fan->slot];
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t row = row_of(fan[i].a);
    columns_[i] = column_of(row);
    rows_[i] = row_values(row);
  }
  const auto add = [&](std::uint32_t i, std::uint32_t j, double value) {
    const std::uint32_t p = columns_[i], q = columns_[j];
    if (p == q) {
      rows_[i][p] += 2 * value;
    } else {
      (p > q ? rows_[i] : rows_[j])[std::min(p, q)] += value;
    }
  };
  const std::uint32_t centre = centre_row_[place];
  if (centre != kNoIndex) {
    double* const row = row_values(centre);
    for (std::uint32_t i = 0; i < n; ++i) {
      rows_[i][columns_[i]] += coupling[i].own;
      add(i, i + 1 == n ? 0 : i + 1, coupling[i].next);
      row[columns_[i]] += coupling[i].centre;
    }
    row[column_of(centre)] = inverse > 0 ? 1 / inverse : 0;
    return;
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const double scaled = coupling[i].centre * inverse;
    rows_[i][columns_[i]] += coupling[i].own - coupling[i].centre * scaled;
    for (std::uint32_t j = 0; j < i; ++j) add(i, j, -scaled * coupling[j].centre);
    add(i, i + 1 == n ? 0 : i + 1, coupling[i].next);
  }
}

void FanSolver::step(double relaxation, std::span<Vec2d> uvs) {
  load_.assign(joined_.cells.size() + 2 * first_.size(), Vec2d{});
  (has_wide_vectors ? Kernels::step_wide : Kernels::step_narrow)(*this, relaxation, uvs.data());
}

}  // namespace atlas
