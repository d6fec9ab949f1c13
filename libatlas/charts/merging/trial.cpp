#include "libatlas/charts/merging/trial.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/hull.h"

namespace atlas {
namespace {

// Relative error of lengths, as float coordinates have for a part that lies a hundred times its
// size from the origin.
constexpr double kUnrolledError = 1e-3;
// The share of hull and rectangle that charts that unroll have to fill. It is low because their
// parts may be needles, and they go on growing.
constexpr double kUnrolledFill = 0.3;
// Relaxation of the steps of a descent. Long steps serve what settles slowly, and plain ones what
// those overshoot. Five plain steps reach no lower energy (measured on 240 meshes).
constexpr std::array kRelaxation{1.0, 2.5, 1.0, 1.5};
// A start is hopeless if it has flipped triangles and this many times the allowed energy, or if the
// halves lie farther apart than TrialLimits::far_apart. Measured on 33 meshes
// with some 19 000 trials: this ended 2800 without a descent, which saved half of the time for
// refused trials, and 2 of these would have come within the limits. Large halves recover more
// often.
constexpr double kFoldedStart = 12, kFoldedLargeStart = 60;
constexpr std::size_t kLargeHalf = 7;  // cells
// The limit for halves that meet along several runs. Of some 24 000 such trials that began with
// flips, 190 came within the limits, for a quarter of the time of all trials (200 meshes). They are
// tried again along the longest run alone.
constexpr double kFoldedRing = 2;
// Halves that fit each other this closely, with so small a share of the allowed energy, count as
// descended. This saves a twelfth of the time of all trials.
constexpr double kCloseFit = 0.005, kSettledStart = 0.05;
constexpr double kLastFall = 0.5;  // further steps leave at least this share of the energy
// No descent in the same trials changed the filled share of the hull or rectangle by more than
// this.
constexpr double kShapeChange = 0.04;
// A union that fills little of its rectangle is accepted if that is no larger than the rectangles
// of both halves together, but for rounding. A needle fills half of its rectangle, and so do two
// needles side by side, as around the tip of a cone.
constexpr double kNoLarger = 1.001;
// A crossing is deep beyond this share of the chart's size. Shallower ones may vanish when the
// chart grows: of 1220 charts that had crossed themselves and were tried again, 9 no longer did. 6
// of these 9 had been shallow, as had 150 of all 1220 (90 meshes).
constexpr double kDeepCrossing = 0.002;

}  // namespace

void Trial::assemble(const TrialPair& charts, const std::vector<std::uint8_t>& joined) {
  joined_.assemble(charts, joined);
  area_ = 0;
  for (const std::uint32_t k : joined_.cells()) area_ += mesh_.cells[k].area;
}

// A rotation about `from`, followed by the translation that takes `from` to `to`.
struct Trial::Move {
  glm::dvec2 from, to;
  double c, s;

  Vec2d operator()(const Vec2d& p) const {
    const double x = p.x - from.x, y = p.y - from.y;
    return {c * x - s * y + to.x, s * x + c * y + to.y};
  }
};

// Brings the second chart's coordinates next to the first's (rigid Procrustes alignment of the
// glued slots) and averages them where they meet.
void Trial::align(std::span<const std::uint32_t> glue) {
  glm::dvec2 mean_p(0), mean_q(0);
  pairs_.clear();
  for (const std::uint32_t arc : glue) {
    const CoarseArc& a = mesh_.arcs[arc];
    const std::uint32_t next0 = mesh_.next_slot(a.slot[0], mesh_.cells[a.cell[0]]);
    const std::uint32_t next1 = mesh_.next_slot(a.slot[1], mesh_.cells[a.cell[1]]);
    if (joined_.in_first(a.cell[0])) {
      pairs_.push_back({a.slot[0], next1});
      pairs_.push_back({next0, a.slot[1]});
    } else {
      pairs_.push_back({next1, a.slot[0]});
      pairs_.push_back({a.slot[1], next0});
    }
  }
  for (const auto& [p, q] : pairs_) {
    mean_p += to_glm(uv_.slot[p]);
    mean_q += to_glm(uv_.slot[q]);
  }
  const double n = std::max<std::size_t>(1, pairs_.size());
  mean_p /= n;
  mean_q /= n;
  double c = 0, s = 0;
  for (const auto& [p, q] : pairs_) {
    const glm::dvec2 a = to_glm(uv_.slot[p]) - mean_p, b = to_glm(uv_.slot[q]) - mean_q;
    c += glm::dot(a, b);
    s += b.x * a.y - b.y * a.x;
  }
  const double norm = std::sqrt(c * c + s * s);
  c = norm > 0 ? c / norm : 1;
  s = norm > 0 ? s / norm : 0;
  misfit_ = 0;
  for (const auto& [p, q] : pairs_) {
    const glm::dvec2 a = to_glm(uv_.slot[p]) - mean_p, b = to_glm(uv_.slot[q]) - mean_q;
    misfit_ = std::max(misfit_, glm::distance(a, {c * b.x - s * b.y, s * b.x + c * b.y}));
  }
  place({mean_q, mean_p, c, s});
}

// Places all vertices. A vertex that joins several slots gets the mean of their places.
void Trial::place(const Move& of_second) {
  uvs_.assign(joined_.vertex_count(), Vec2d{});
  weight_.assign(uvs_.size(), 0);
  const auto add = [&](std::uint32_t v, const Vec2d& p) {
    uvs_[v].x += p.x;
    uvs_[v].y += p.y;
    weight_[v] += 1;
  };
  const std::span<const std::uint32_t> cells = joined_.cells();
  const std::size_t firsts = joined_.first_count();
  for (std::uint32_t i = 0; i < cells.size(); ++i) {
    const Vec2d& centre = uv_.centre[cells[i]];
    uvs_[i] = i < firsts ? centre : of_second(centre);
    weight_[i] = 1;
  }
  const auto triangles = joined_.triangles();
  std::size_t t = 0;
  for (; t < triangles.size() && triangles[t].centre < firsts; ++t) {
    add(triangles[t].a, uv_.slot[triangles[t].slot]);
  }
  for (; t < triangles.size(); ++t) add(triangles[t].a, of_second(uv_.slot[triangles[t].slot]));
  for (std::size_t v = cells.size(); v < uvs_.size(); ++v) {
    uvs_[v].x /= weight_[v];
    uvs_[v].y /= weight_[v];
  }
}

// Fills the stretch of the outcome. Returns false if a triangle is flipped; then only the energy is
// filled.
bool Trial::measure_stretch(double stretch_high, TrialOutcome& outcome) {
  const FanStretch stretch = measure_.stretch(joined_.fans(), uvs_, stretch_high);
  outcome.energy = stretch.energy;
  if (stretch.flipped) return false;
  outcome.stretch_l2 = stretch.l2;
  outcome.high_area = stretch.high_area;
  return true;
}

bool Trial::stretch_fits(const TrialLimits& limits, TrialOutcome& outcome) {
  return measure_stretch(limits.stretch_high, outcome) && outcome.stretch_l2 <= limits.stretch_l2 &&
         outcome.high_area <= limits.high_area;
}

Trial::Start Trial::judge_start(std::size_t smaller_half, const TrialLimits& limits,
                                TrialOutcome& outcome) {
  const double allowed = area_ * (limits.stretch_l2 * limits.stretch_l2 - 1);
  const double misfit = area_ > 0 ? misfit_ / std::sqrt(area_) : 0;
  if (!flipped_ && misfit > kCloseFit && misfit <= limits.far_apart) return Start::open;
  const bool whole = measure_stretch(limits.stretch_high, outcome);
  if (whole && misfit <= kCloseFit && outcome.energy <= kSettledStart * allowed &&
      outcome.high_area <= limits.high_area) {
    return Start::settled;
  }
  const bool disc = outcome.euler == 1;
  const double most = !disc                       ? kFoldedRing
                      : smaller_half < kLargeHalf ? kFoldedStart
                                                  : kFoldedLargeStart;
  if (misfit <= limits.far_apart && (whole || outcome.energy <= most * allowed)) return Start::open;
  // The least energy that ends a descent: a start says little about where it leads.
  outcome.energy = kLastFall * allowed;
  outcome.high_area = 0;
  return Start::hopeless;
}

double Trial::box(std::span<const std::uint32_t> cells) {
  points_.clear();
  for (const std::uint32_t k : cells) {
    const CoarseCell& cell = mesh_.cells[k];
    const auto first = uv_.slot.begin() + cell.first_slot;
    points_.insert(points_.end(), first, first + cell.slot_count);
  }
  hull_area(points_, hull_);
  return box_area(hull_);
}

// Whether the union fills hull and rectangle as far as the limits require, or by `slack` less.
bool Trial::shape_fits(const TrialLimits& limits, double slack, TrialOutcome& outcome) {
  points_.clear();
  for (const auto& [a, b] : joined_.border()) points_.push_back(uvs_[a]);
  const double twice = measure_.twice_area(joined_.fans(), uvs_, flipped_);
  // Bounds suffice if the shape passes anyway, even after any change that a descent may make.
  const double enough = slack > 0 ? kShapeChange : 0;
  const ShapeBounds most = bound_shape(points_);
  outcome.solidity = 0.5 * twice / most.hull;
  outcome.fill = 0.5 * twice / most.box;
  if (outcome.solidity >= limits.solidity + enough && outcome.fill >= limits.fill + enough) {
    return true;
  }
  const double hull = hull_area(points_, hull_);
  outcome.solidity = hull > 0 ? 0.5 * twice / hull : 1;
  if (outcome.solidity < limits.solidity - slack) return false;
  const double box = box_area(hull_);
  outcome.fill = box > 0 ? 0.5 * twice / box : 1;
  return outcome.fill >= limits.fill - slack || box <= kNoLarger * limits.box;
}

Crossing Trial::border_crossing() {
  return crossings_.find(joined_.border(), uvs_, kDeepCrossing * std::sqrt(area_));
}

TrialOutcome Trial::run(const TrialPair& charts, std::vector<std::uint8_t>& joined,
                        const TrialLimits& limits) {
  for (const std::uint32_t arc : charts.glue) joined[arc] = 1;
  assemble(charts, joined);
  const TrialOutcome outcome = judge(charts.glue, limits);
  if (!outcome.accepted) {
    for (const std::uint32_t arc : charts.glue) joined[arc] = 0;
  }
  return outcome;
}

void Trial::join_flat(const TrialPair& charts, std::vector<std::uint8_t>& joined) {
  for (const std::uint32_t arc : charts.glue) joined[arc] = 1;
  assemble(charts, joined);
  align(charts.glue);
}

// Whether the aligned halves keep all lengths, as those of boxes and tubes do. A descent would then
// change nothing that the limits could detect.
bool Trial::unrolled() const {
  const auto kept = [&](std::uint32_t a, std::uint32_t b, double squared) {
    const glm::dvec2 flat = to_glm(uvs_[b]) - to_glm(uvs_[a]);
    return std::abs(glm::dot(flat, flat) - squared) <= 2 * kUnrolledError * squared;
  };
  for (const JoinedFans::Triangle& t : joined_.triangles()) {
    if (!kept(t.centre, t.a, fans_.spoke_squared[t.slot]) ||
        !kept(t.a, t.b, fans_.rim_squared[t.slot])) {
      return false;
    }
  }
  return true;
}

// Whether two charts that unroll still do so when joined, that is, whether their sides match.
bool Trial::fits_unrolled(TrialOutcome& outcome) {
  const double area = measure_.mapped_area(joined_.fans(), uvs_);
  outcome.unrolled = area > 0 && misfit_ < kUnrolledError * std::sqrt(area);
  return outcome.unrolled;
}

void Trial::descend() {
  solver_.factorize(joined_.fans(), uvs_.size());
  for (const double relaxation : kRelaxation) solver_.step(relaxation, uvs_);
}

TrialOutcome Trial::judge(std::span<const std::uint32_t> glue, const TrialLimits& limits) {
  TrialOutcome outcome;
  outcome.euler = joined_.euler();
  if (outcome.euler > 1 || joined_.border().empty()) return outcome;
  align(glue);
  if (limits.unrolls && outcome.euler == 1 && fits_unrolled(outcome)) {
    TrialLimits shape = limits;
    shape.solidity = std::min(limits.solidity, kUnrolledFill);
    shape.fill = std::min(limits.fill, kUnrolledFill);
    outcome.accepted = shape_fits(shape, 0, outcome) && border_crossing() == Crossing::none;
    return outcome;
  }
  if (unrolled()) {
    outcome.solidity = outcome.fill = 0;  // not known yet
  } else {
    if (!shape_fits(limits, kShapeChange, outcome)) return outcome;
    const std::size_t first = joined_.first_count(), second = joined_.cells().size() - first;
    const Start start = judge_start(std::min(first, second), limits, outcome);
    if (start == Start::hopeless) return outcome;
    if (start == Start::open) descend();
  }
  outcome.settled = true;
  if (!stretch_fits(limits, outcome)) return outcome;
  const bool clear = outcome.solidity >= limits.solidity + kShapeChange &&
                     outcome.fill >= limits.fill + kShapeChange;
  if (!clear && !shape_fits(limits, 0, outcome)) return outcome;
  const Crossing crossing = border_crossing();
  outcome.entangled = crossing == Crossing::deep;
  outcome.accepted = crossing == Crossing::none;
  return outcome;
}

void Trial::commit() {
  joined_.commit();
  const std::span<const std::uint32_t> cells = joined_.cells();
  for (std::uint32_t c = 0; c < cells.size(); ++c) uv_.centre[cells[c]] = uvs_[c];
  for (const JoinedFans::Triangle& t : joined_.triangles()) uv_.slot[t.slot] = uvs_[t.a];
}

}  // namespace atlas
