#include "libatlas/charts/trial.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libatlas/charts/hull.h"
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
// Halves that fit each other so closely and with so little of the energy allowed are as good as
// descended: this spares a twelfth of all trials' time.
constexpr double kCloseFit = 0.005, kSettledStart = 0.05;
constexpr double kLastFall = 0.5;  // what further steps leave of energy, at least
// A descent never changed the share of hull or rectangle that is filled by more (the same trials).
constexpr double kShapeChange = 0.04;
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
  uvs_.assign(joined_.vertex_count(), Vec2d{});
  weight_.assign(uvs_.size(), 0);
  const auto add = [&](std::uint32_t v, Vec2d p, bool second) {
    if (second) {
      const double x = p.x - mean_q.x, y = p.y - mean_q.y;
      p = {c * x - s * y + mean_p.x, s * x + c * y + mean_p.y};
    }
    uvs_[v].x += p.x;
    uvs_[v].y += p.y;
    weight_[v] += 1;
  };
  const std::span<const std::uint32_t> cells = joined_.cells();
  for (std::uint32_t i = 0; i < cells.size(); ++i) {
    add(i, uv_.centre[cells[i]], i >= joined_.first_count());
  }
  for (const JoinedFans::Triangle& t : joined_.triangles()) {
    add(t.a, uv_.slot[t.slot], t.centre >= joined_.first_count());
  }
  for (std::size_t v = 0; v < uvs_.size(); ++v) {
    uvs_[v].x /= weight_[v];
    uvs_[v].y /= weight_[v];
  }
}

void Trial::measure_maps() {
  maps_.clear();
  for (const JoinedFans::Triangle& t : joined_.triangles()) {
    const FanTriangle& fan = fans_.triangle[t.slot];
    const glm::dvec2 g1 = to_glm(fan.slot_gradient), g2 = to_glm(fan.next_gradient);
    const glm::dvec2 centre = to_glm(uvs_[t.centre]);
    const glm::dvec2 d1 = to_glm(uvs_[t.a]) - centre, d2 = to_glm(uvs_[t.b]) - centre;
    const glm::dvec2 x = g1.x * d1 + g2.x * d2, y = g1.y * d1 + g2.y * d2;  // times area
    const double scale = fan.inverse_area * fan.inverse_area;
    maps_.push_back({(glm::dot(x, x) + glm::dot(y, y)) * scale, (x.x * y.y - x.y * y.x) * scale});
  }
}

// Fills maps_ and what the outcome says of stretch; false: a triangle is flipped, and only the
// energy was found.
bool Trial::measure_stretch(double stretch_high, TrialOutcome& outcome) {
  measure_maps();
  const auto triangles = joined_.triangles();
  double area = 0, uv_area = 0, l2 = 0;
  bool flipped = false;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const double own = fans_.triangle[triangles[i].slot].area;
    if (!(own > 0)) continue;
    const auto [squares, product] = maps_[i];
    flipped |= product <= 0;
    area += own;
    uv_area += own * product;
    l2 += own * (squares / (product * product));
  }
  if (flipped) {
    // Of the singular values less 1, the smaller one with the sign of the product.
    double rigid = 0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const auto [squares, product] = maps_[i];
      const double sum = std::sqrt(std::max(squares + 2 * product, 0.0));
      rigid += fans_.triangle[triangles[i].slot].area * (squares - 2 * sum + 2);
    }
    outcome.energy = rigid;
    return false;
  }
  const double squared = area > 0 ? uv_area / area : 1;  // the scale's
  l2 *= 0.5 * squared;
  // Whether the larger singular value or the inverse of the smaller one is too large: the squares
  // of both are the roots of x² - squares x + product².
  const double most = stretch_high * stretch_high * squared;
  const double least = squared / (stretch_high * stretch_high);
  double above = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto [squares, product] = maps_[i];
    const double last = product * product;
    const bool high = most * (most - squares) + last < 0 || 2 * most < squares ||
                      least * (least - squares) + last < 0 || 2 * least > squares;
    if (high) above += fans_.triangle[triangles[i].slot].area;
  }
  outcome.stretch_l2 = area > 0 ? std::sqrt(l2 / area) : 1;
  outcome.energy = l2 - area;
  outcome.high_area = above;
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
  const double most = smaller_half < kLargeHalf ? kFoldedStart : kFoldedLargeStart;
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

// Whether hull and rectangle are filled as far as the limits say, or by `slack` less.
bool Trial::shape_fits(const TrialLimits& limits, double slack, TrialOutcome& outcome) {
  points_.clear();
  for (const auto& [a, b] : joined_.border()) points_.push_back(uvs_[a]);
  double twice = 0;
  flipped_ = false;
  for (const JoinedFans::Triangle& t : joined_.triangles()) {
    const double double_area = cross(uvs_[t.centre], uvs_[t.a], uvs_[t.b]);
    flipped_ |= double_area <= 0 && fans_.triangle[t.slot].area > 0;
    twice += double_area;
  }
  const double hull = hull_area(points_, hull_);
  outcome.solidity = hull > 0 ? 0.5 * twice / hull : 1;
  if (outcome.solidity < limits.solidity - slack) return false;
  const double box = box_area(hull_);
  outcome.fill = box > 0 ? 0.5 * twice / box : 1;
  return outcome.fill >= limits.fill - slack;
}

namespace {

// How far one of two edges that cross would have to move for them not to.
double crossing_depth(const Vec2d& a, const Vec2d& b, const Vec2d& c, const Vec2d& d) {
  const auto nearest = [](const Vec2d& p, const Vec2d& q, const Vec2d& r, const Vec2d& s) {
    const double length = std::hypot(q.x - p.x, q.y - p.y);
    return std::min(std::abs(cross(p, q, r)), std::abs(cross(p, q, s))) / length;
  };
  return std::min(nearest(a, b, c, d), nearest(c, d, a, b));
}

}  // namespace

Trial::Crossing Trial::border_crossing() {
  const double deep = kDeepCrossing * std::sqrt(area_);
  Crossing crossing = Crossing::none;
  border_.assign(joined_.border().begin(), joined_.border().end());
  const auto left = [&](const std::array<std::uint32_t, 2>& e) {
    return std::min(uvs_[e[0]].x, uvs_[e[1]].x);
  };
  std::sort(border_.begin(), border_.end(),
            [&](const auto& e, const auto& f) { return left(e) < left(f); });
  for (std::size_t i = 0; i < border_.size(); ++i) {
    const auto& [a, b] = border_[i];
    const double right = std::max(uvs_[a].x, uvs_[b].x);
    for (std::size_t j = i + 1; j < border_.size() && left(border_[j]) <= right; ++j) {
      const auto& [c, d] = border_[j];
      if (a == c || a == d || b == c || b == d) continue;
      if (cross_each_other(uvs_[a], uvs_[b], uvs_[c], uvs_[d])) {
        crossing = Crossing::shallow;
        if (crossing_depth(uvs_[a], uvs_[b], uvs_[c], uvs_[d]) > deep) return Crossing::deep;
      }
    }
  }
  return crossing;
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
    const FanTriangle& fan = fans_.triangle[t.slot];
    if (!kept(t.centre, t.a, fan.spoke_squared) || !kept(t.a, t.b, fan.rim_squared)) return false;
  }
  return true;
}

// Whether two charts that unroll still do when they are joined: then their sides match.
bool Trial::fits_unrolled(TrialOutcome& outcome) {
  measure_maps();
  double area = 0;
  for (std::size_t i = 0; i < maps_.size(); ++i) {
    area += fans_.triangle[joined_.triangles()[i].slot].area * maps_[i].product;
  }
  outcome.unrolled = area > 0 && misfit_ < kUnrolledError * std::sqrt(area);
  return outcome.unrolled;
}

// False: it was ended before its time, for it would not have met the limits.
bool Trial::descend(const TrialLimits& limits, TrialOutcome& outcome) {
  joined_.order(uvs_);
  solver_.factorize(joined_.fans(), uvs_.size());
  for (std::size_t i = 0; i < kRelaxation.size(); ++i) {
    if (i == kLookAfter && !promising(limits, outcome)) return false;
    solver_.step(kRelaxation[i], uvs_);
  }
  return true;
}

TrialOutcome Trial::judge(std::span<const std::uint32_t> glue, const TrialLimits& limits) {
  TrialOutcome outcome;
  outcome.euler = joined_.euler();
  if (outcome.euler > 1 || joined_.border().empty() || limits.hopeless) return outcome;
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
