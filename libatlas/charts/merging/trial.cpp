#include "libatlas/charts/merging/trial.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libatlas/charts/geometry/hull.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

// Of lengths: float coordinates of a part that lies a hundred of its sizes from the origin.
constexpr double kUnrolledError = 1e-3;
// Of hull and rectangle, by what unrolls: its parts may be needles, and it will go on growing.
constexpr double kUnrolledFill = 0.3;
// The steps of a descent, relaxed in turn: a long one for what is slow to settle, and a plain one
// for what that overshoots. Five plain steps end no lower (measured on 240 meshes).
constexpr std::array kRelaxation{1.0, 2.5, 1.0, 1.5};
// After two steps a descent is far from its end if its energy is still so many times the one
// allowed, less with flips, or the area with high stretch, or both by less. Of 15600 descents on
// 130 meshes that failed this ends 5900 early, and of 39300 others 70.
constexpr std::size_t kLookAfter = 2;
constexpr double kFarEnergy = 1.5, kFarWithFlips = 1, kFarArea = 8;
constexpr double kNearEnergy = 0.9, kNearArea = 3;
// Halves that meet with flipped triangles and so many times the energy allowed, or so far apart for
// their size, do not settle: of some 19000 trials on 33 meshes this ended 2800 unseen, half of the
// time that refusals took, and two that would have come within the limits. Large halves may.
constexpr double kFoldedStart = 12, kFoldedLargeStart = 60, kFarApart = 0.3;
constexpr std::size_t kLargeHalf = 7;  // cells
// Halves that meet in several stretches: of some 24000 such trials that began with flips 190 came
// within the limits, in a quarter of all trials' time (200 meshes); along the longest stretch alone
// they are tried again.
constexpr double kFoldedRing = 2;
// Halves that fit each other so closely and with so little of the energy allowed are as good as
// descended: this spares a twelfth of all trials' time.
constexpr double kCloseFit = 0.005, kSettledStart = 0.05;
constexpr double kLastFall = 0.5;  // what further steps leave of energy, at least
// A descent never changed the share of hull or rectangle that is filled by more (the same trials).
constexpr double kShapeChange = 0.04;
// What fills its rectangle poorly wastes no more of it than its halves do, but for rounding: a
// needle fills half of its own, and so do two side by side, as around the tip of a cone.
constexpr double kNoLarger = 1.001;
// What so few cells that are joined to so many change lies around them: descending there alone, a
// wheel whose charts have hundreds of cells is merged in 0.7 instead of 1.6 s. 8448 charts of 276
// meshes became 8432.
constexpr std::size_t kLargeChart = 96, kLittleChart = 6, kPatchCells = 40;
// Of the chart's size: what crosses itself by less may come apart when the chart grows. Of 1220
// that had crossed and were tried again 9 did, 6 of them from less, as 150 of all (90 meshes).
constexpr double kDeepCrossing = 0.002;

}  // namespace

void Trial::assemble(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second,
                     std::span<const std::uint32_t> glue, const std::vector<std::uint8_t>& joined) {
  joined_.assemble(first, second, glue, joined);
  area_ = 0;
  for (const std::uint32_t k : joined_.cells()) area_ += mesh_.cells[k].area;
}

// A rotation about a point, then what takes that point to another.
struct Trial::Move {
  glm::dvec2 from, to;
  double c, s;

  Vec2d operator()(const Vec2d& p) const {
    const double x = p.x - from.x, y = p.y - from.y;
    return {c * x - s * y + to.x, s * x + c * y + to.y};
  }
};

// Brings the second chart's coordinates next to the first's (rigid Procrustes on the glued slots)
// and averages where they meet.
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

// Vertices that several slots are joined to lie between these.
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

// Fills what the outcome says of stretch; false: a triangle is flipped, and only the energy was
// found.
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
  if (!flipped_ && misfit > kCloseFit && misfit <= kFarApart) return Start::open;
  const bool whole = measure_stretch(limits.stretch_high, outcome);
  if (whole && misfit <= kCloseFit && outcome.energy <= kSettledStart * allowed &&
      outcome.high_area <= limits.high_area) {
    return Start::settled;
  }
  const bool disc = outcome.euler == 1;
  const double most = !disc                       ? kFoldedRing
                      : smaller_half < kLargeHalf ? kFoldedStart
                                                  : kFoldedLargeStart;
  if (misfit <= kFarApart && (whole || outcome.energy <= most * allowed)) return Start::open;
  // The least that ends a descent: a start says little of where it leads.
  outcome.energy = kLastFall * kFarWithFlips * allowed;
  outcome.high_area = 0;
  return Start::hopeless;
}

// Whether a descent may still end within the limits.
bool Trial::promising(const TrialLimits& limits, TrialOutcome& outcome) {
  const bool whole = measure_stretch(limits.stretch_high, outcome);
  const double energy = outcome.energy / (area_ * (limits.stretch_l2 * limits.stretch_l2 - 1));
  const double most_area = (energy > kNearEnergy ? kNearArea : kFarArea) * limits.high_area;
  const bool far =
      whole ? energy > kFarEnergy || outcome.high_area > most_area : energy > kFarWithFlips;
  if (!far) return true;
  outcome.energy *= kLastFall;
  outcome.high_area *= kLastFall;
  return false;
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

// Whether hull and rectangle are filled as far as the limits say, or by `slack` less.
bool Trial::shape_fits(const TrialLimits& limits, double slack, TrialOutcome& outcome) {
  points_.clear();
  for (const auto& [a, b] : joined_.border()) points_.push_back(uvs_[a]);
  const double twice = measure_.twice_area(joined_.fans(), uvs_, flipped_);
  // A passing shape need not be known any better, nor one that stays so whatever a descent does.
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

TrialOutcome Trial::run(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second,
                        std::span<const std::uint32_t> glue, std::vector<std::uint8_t>& joined,
                        const TrialLimits& limits) {
  for (const std::uint32_t arc : glue) joined[arc] = 1;
  assemble(first, second, glue, joined);
  const TrialOutcome outcome = judge(glue, limits);
  if (!outcome.accepted) {
    for (const std::uint32_t arc : glue) joined[arc] = 0;
  }
  return outcome;
}

void Trial::join_flat(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second,
                      std::span<const std::uint32_t> glue, std::vector<std::uint8_t>& joined) {
  for (const std::uint32_t arc : glue) joined[arc] = 1;
  assemble(first, second, glue, joined);
  align(glue);
}

// Whether the aligned halves keep all lengths as they are, as those of boxes and tubes do: a
// descent would change nothing that the limits could see.
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

// Whether two charts that unroll still do when they are joined: then their sides match.
bool Trial::fits_unrolled(TrialOutcome& outcome) {
  const double area = measure_.mapped_area(joined_.fans(), uvs_);
  outcome.unrolled = area > 0 && misfit_ < kUnrolledError * std::sqrt(area);
  return outcome.unrolled;
}

// False: it was ended before its time, for it would not have met the limits.
bool Trial::descend(const TrialLimits& limits, TrialOutcome& outcome) {
  const std::size_t all = joined_.cells().size();
  const bool little = all >= kLargeChart && all - joined_.first_count() <= kLittleChart;
  if (little) {
    patch_.take(joined_, kPatchCells, uvs_);
    solver_.factorize(patch_.fans(), patch_.first_held(), patch_.uvs());
  } else {
    solver_.factorize(joined_.fans(), uvs_.size());
  }
  const std::span<Vec2d> moving = little ? patch_.uvs() : uvs_;
  for (std::size_t i = 0; i < kRelaxation.size(); ++i) {
    if (i == kLookAfter) {
      if (little) patch_.give_back(uvs_);
      if (!promising(limits, outcome)) return false;
    }
    solver_.step(kRelaxation[i], moving);
  }
  if (little) patch_.give_back(uvs_);
  return true;
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
    if (start == Start::open && !descend(limits, outcome)) return outcome;
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
