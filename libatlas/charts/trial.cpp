#include "libatlas/charts/trial.h"

#include <algorithm>
#include <cmath>

#include "libatlas/charts/hull.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

// Of lengths: float coordinates of a part that lies a hundred of its sizes from the origin.
constexpr double kUnrolledError = 1e-3;
// Of hull and rectangle, by what unrolls: its parts may be needles, and it will go on growing.
constexpr double kUnrolledFill = 0.3;
// After two steps a descent is far from its end if its stretch is still so many times the limit,
// less with flips, or if area and stretch are both beyond theirs by so much. Of some 6000 trials on
// twelve meshes this ended 1500 early, and none that would have come within the limits.
constexpr double kFarStretch = 2.5, kFarWithFlips = 1.2, kFarArea = 6, kNearStretch = 0.9;
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

}  // namespace

std::uint32_t Trial::root(std::uint32_t slot) {
  while (slot_vertex_[slot] != slot) slot = slot_vertex_[slot] = slot_vertex_[slot_vertex_[slot]];
  return slot;
}

void Trial::join(std::uint32_t arc) {
  const CoarseArc& a = mesh_.arcs[arc];
  const std::uint32_t next0 = mesh_.next_slot(a.slot[0], mesh_.cells[a.cell[0]]);
  const std::uint32_t next1 = mesh_.next_slot(a.slot[1], mesh_.cells[a.cell[1]]);
  slot_vertex_[root(a.slot[0])] = root(next1);
  slot_vertex_[root(next0)] = root(a.slot[1]);
}

// Local vertices: the cells' centres in order, then the classes of joined slots.
void Trial::assemble(const std::vector<std::uint8_t>& joined) {
  for (const std::uint32_t k : cells_) {
    const CoarseCell& cell = mesh_.cells[k];
    for (std::uint32_t s = cell.first_slot; s < cell.first_slot + cell.slot_count; ++s) {
      slot_vertex_[s] = s;
    }
  }
  for (const std::uint32_t k : cells_) {
    const CoarseCell& cell = mesh_.cells[k];
    for (std::uint32_t s = cell.first_slot; s < cell.first_slot + cell.slot_count; ++s) {
      const std::uint32_t arc = mesh_.slot_arc[s];
      if (joined[arc] && mesh_.arcs[arc].slot[0] == s) join(arc);
    }
  }
  positions_.clear();
  vertex_slot_.assign(cells_.size(), kNoIndex);
  const Vec3d origin = mesh_.cells[cells_[0]].centre;
  const auto add = [&](const Vec3d& p) {
    positions_.push_back({p.x - origin.x, p.y - origin.y, p.z - origin.z});
  };
  for (const std::uint32_t k : cells_) add(mesh_.cells[k].centre);
  for (const std::uint32_t k : cells_) {
    const CoarseCell& cell = mesh_.cells[k];
    for (std::uint32_t s = cell.first_slot; s < cell.first_slot + cell.slot_count; ++s) {
      if (slot_vertex_[s] != s) continue;
      vertex_slot_.push_back(s);
      add(mesh_.slot_position[s]);
    }
  }
  // Parents become vertices in two steps, for a root may come after its children.
  roots_.clear();
  for (const std::uint32_t k : cells_) {
    const CoarseCell& cell = mesh_.cells[k];
    for (std::uint32_t s = cell.first_slot; s < cell.first_slot + cell.slot_count; ++s) {
      roots_.push_back(root(s));
    }
  }
  for (std::size_t v = cells_.size(); v < vertex_slot_.size(); ++v) {
    slot_vertex_[vertex_slot_[v]] = static_cast<std::uint32_t>(v);
  }
  std::size_t i = 0;
  for (const std::uint32_t k : cells_) {
    const CoarseCell& cell = mesh_.cells[k];
    for (std::uint32_t s = cell.first_slot; s < cell.first_slot + cell.slot_count; ++s, ++i) {
      if (roots_[i] != s) slot_vertex_[s] = slot_vertex_[roots_[i]];
    }
  }
  triangles_.clear();
  for (std::uint32_t c = 0; c < cells_.size(); ++c) {
    const CoarseCell& cell = mesh_.cells[cells_[c]];
    for (std::uint32_t s = cell.first_slot; s < cell.first_slot + cell.slot_count; ++s) {
      const std::uint32_t a = slot_vertex_[s], b = slot_vertex_[mesh_.next_slot(s, cell)];
      if (a != b) triangles_.push_back({c, a, b});
    }
  }
}

// Brings the second chart's coordinates next to the first's (rigid Procrustes on the glued slots)
// and averages where they meet.
void Trial::align(std::size_t first_cells, std::span<const std::uint32_t> glue) {
  glm::dvec2 mean_p(0), mean_q(0);
  std::vector<std::array<std::uint32_t, 2>>& pairs = border_;  // slots of first and second chart
  pairs.clear();
  for (const std::uint32_t arc : glue) {
    const CoarseArc& a = mesh_.arcs[arc];
    bool zero_is_first = false;
    for (std::size_t c = 0; c < first_cells; ++c) zero_is_first |= cells_[c] == a.cell[0];
    const std::uint32_t next0 = mesh_.next_slot(a.slot[0], mesh_.cells[a.cell[0]]);
    const std::uint32_t next1 = mesh_.next_slot(a.slot[1], mesh_.cells[a.cell[1]]);
    if (zero_is_first) {
      pairs.push_back({a.slot[0], next1});
      pairs.push_back({next0, a.slot[1]});
    } else {
      pairs.push_back({next1, a.slot[0]});
      pairs.push_back({a.slot[1], next0});
    }
  }
  for (const auto& [p, q] : pairs) {
    mean_p += to_glm(uv_.slot[p]);
    mean_q += to_glm(uv_.slot[q]);
  }
  const double n = std::max<std::size_t>(1, pairs.size());
  mean_p /= n;
  mean_q /= n;
  double c = 0, s = 0;
  for (const auto& [p, q] : pairs) {
    const glm::dvec2 a = to_glm(uv_.slot[p]) - mean_p, b = to_glm(uv_.slot[q]) - mean_q;
    c += glm::dot(a, b);
    s += b.x * a.y - b.y * a.x;
  }
  const double norm = std::sqrt(c * c + s * s);
  c = norm > 0 ? c / norm : 1;
  s = norm > 0 ? s / norm : 0;
  misfit_ = 0;
  for (const auto& [p, q] : pairs) {
    const glm::dvec2 a = to_glm(uv_.slot[p]) - mean_p, b = to_glm(uv_.slot[q]) - mean_q;
    misfit_ = std::max(misfit_, glm::distance(a, {c * b.x - s * b.y, s * b.x + c * b.y}));
  }
  uvs_.assign(positions_.size(), Vec2d{});
  weight_.assign(positions_.size(), 0);
  const auto add = [&](std::uint32_t v, Vec2d p, bool second) {
    if (second) {
      const double x = p.x - mean_q.x, y = p.y - mean_q.y;
      p = {c * x - s * y + mean_p.x, s * x + c * y + mean_p.y};
    }
    uvs_[v].x += p.x;
    uvs_[v].y += p.y;
    weight_[v] += 1;
  };
  for (std::uint32_t i = 0; i < cells_.size(); ++i) {
    const bool second = i >= first_cells;
    const CoarseCell& cell = mesh_.cells[cells_[i]];
    add(i, uv_.centre[cells_[i]], second);
    for (std::uint32_t k = cell.first_slot; k < cell.first_slot + cell.slot_count; ++k) {
      add(slot_vertex_[k], uv_.slot[k], second);
    }
  }
  for (std::size_t v = 0; v < uvs_.size(); ++v) {
    uvs_[v].x /= weight_[v];
    uvs_[v].y /= weight_[v];
  }
}

// Fills stretch_ and what the outcome says of stretch; false: a triangle is flipped, and only the
// energy was found.
bool Trial::measure_stretch(double stretch_high, TrialOutcome& outcome) {
  stretch_.resize(triangles_.size());
  measure_triangles({positions_, triangles_, {}}, uvs_, stretch_);
  double area = 0, uv_area = 0, rigid = 0;
  bool flipped = false;
  for (const TriangleStretch& t : stretch_) {
    flipped |= t.uv_area <= 0 && t.area > 0;
    area += t.area;
    uv_area += t.uv_area;
  }
  if (flipped) {
    for (const TriangleStretch& t : stretch_) {
      if (!(t.area > 0)) continue;
      const double large = 1 / t.s2 - 1, small = std::copysign(1 / t.s1, t.uv_area) - 1;
      rigid += t.area * (large * large + small * small);
    }
    outcome.energy = rigid;
    return false;
  }
  const double scale = area > 0 ? std::sqrt(uv_area / area) : 1;
  double l2 = 0, above = 0;
  for (const TriangleStretch& t : stretch_) {
    const double s1 = t.s1 * scale, s2 = t.s2 * scale;
    l2 += 0.5 * (s1 * s1 + s2 * s2) * t.area;
    if (std::max(s1, 1 / s2) > stretch_high) above += t.area;
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
  double area = 0;
  for (const std::uint32_t k : cells_) area += mesh_.cells[k].area;
  const double allowed = area * (limits.stretch_l2 * limits.stretch_l2 - 1);
  const double misfit = area > 0 ? misfit_ / std::sqrt(area) : 0;
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
  double area = 0;
  for (const TriangleStretch& t : stretch_) area += t.area;
  const double energy = outcome.energy / (area * (limits.stretch_l2 * limits.stretch_l2 - 1));
  if (energy <= (whole ? kFarStretch : kFarWithFlips) &&
      (energy <= kNearStretch || outcome.high_area <= kFarArea * limits.high_area)) {
    return true;
  }
  outcome.energy *= kLastFall;
  outcome.high_area *= kLastFall;
  return false;
}

// Whether hull and rectangle are filled as far as the limits say, or by `slack` less.
bool Trial::shape_fits(const TrialLimits& limits, double slack, TrialOutcome& outcome) {
  points_.clear();
  for (const auto& [a, b] : border_) points_.push_back(uvs_[a]);
  double twice = 0;
  flipped_ = false;
  for (const auto& [a, b, c] : triangles_) {
    const double double_area = cross(uvs_[a], uvs_[b], uvs_[c]);
    flipped_ |= double_area <= 0;
    twice += double_area;
  }
  const double hull = hull_area(points_, hull_);
  outcome.solidity = hull > 0 ? 0.5 * twice / hull : 1;
  if (outcome.solidity < limits.solidity - slack) return false;
  const double box = box_area(hull_);
  outcome.fill = box > 0 ? 0.5 * twice / box : 1;
  return outcome.fill >= limits.fill - slack;
}

// Fills border_.
void Trial::find_border(const std::vector<std::uint8_t>& joined) {
  border_.clear();
  for (const std::uint32_t k : cells_) {
    const CoarseCell& cell = mesh_.cells[k];
    for (std::uint32_t s = cell.first_slot; s < cell.first_slot + cell.slot_count; ++s) {
      if (joined[mesh_.slot_arc[s]]) continue;
      border_.push_back({slot_vertex_[s], slot_vertex_[mesh_.next_slot(s, cell)]});
    }
  }
}

bool Trial::border_crosses() {
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
      if (cross_each_other(uvs_[a], uvs_[b], uvs_[c], uvs_[d])) return true;
    }
  }
  return false;
}

TrialOutcome Trial::run(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second,
                        std::span<const std::uint32_t> glue, std::vector<std::uint8_t>& joined,
                        const TrialLimits& limits) {
  for (const std::uint32_t arc : glue) joined[arc] = 1;
  const TrialOutcome outcome = run_joined(first, second, glue, joined, limits);
  if (!outcome.accepted) {
    for (const std::uint32_t arc : glue) joined[arc] = 0;
  }
  return outcome;
}

void Trial::join_flat(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second,
                      std::span<const std::uint32_t> glue, std::vector<std::uint8_t>& joined) {
  for (const std::uint32_t arc : glue) joined[arc] = 1;
  cells_.assign(first.begin(), first.end());
  cells_.insert(cells_.end(), second.begin(), second.end());
  assemble(joined);
  align(first.size(), glue);
}

// Whether the aligned halves keep all lengths as they are, as those of boxes and tubes do: a
// descent would change nothing that the limits could see.
bool Trial::unrolled() const {
  for (const auto& triangle : triangles_) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = triangle[k], b = triangle[(k + 1) % 3];
      const glm::dvec3 edge = to_glm(positions_[b]) - to_glm(positions_[a]);
      const glm::dvec2 flat = to_glm(uvs_[b]) - to_glm(uvs_[a]);
      const double squared = glm::dot(edge, edge);
      if (std::abs(glm::dot(flat, flat) - squared) > 2 * kUnrolledError * squared) return false;
    }
  }
  return true;
}

// Whether two charts that unroll still do when they are joined: then their sides match.
bool Trial::fits_unrolled(TrialOutcome& outcome) {
  const LocalMesh mesh{positions_, triangles_, {}};
  stretch_.resize(triangles_.size());
  measure_triangles(mesh, uvs_, stretch_);
  double area = 0;
  for (const TriangleStretch& t : stretch_) area += t.uv_area;
  outcome.unrolled = area > 0 && misfit_ < kUnrolledError * std::sqrt(area);
  return outcome.unrolled;
}

// False: it was ended before its time, for it would not have met the limits.
bool Trial::descend(const TrialLimits& limits, TrialOutcome& outcome) {
  bool hope = true;
  IsometricOptions options;
  options.iterations = limits.iterations;
  options.measure = false;
  options.promising = [&] { return hope = promising(limits, outcome); };
  flatten_isometric({positions_, triangles_, {}}, {uvs_, {}}, options, uvs_, workspace_);
  return hope;
}

TrialOutcome Trial::run_joined(std::span<const std::uint32_t> first,
                               std::span<const std::uint32_t> second,
                               std::span<const std::uint32_t> glue,
                               const std::vector<std::uint8_t>& joined, const TrialLimits& limits) {
  cells_.assign(first.begin(), first.end());
  cells_.insert(cells_.end(), second.begin(), second.end());
  assemble(joined);
  TrialOutcome outcome;
  std::size_t rims = 0, joined_sides = 0;
  for (const std::uint32_t k : cells_) {
    const CoarseCell& cell = mesh_.cells[k];
    rims += cell.slot_count;
    for (std::uint32_t s = cell.first_slot; s < cell.first_slot + cell.slot_count; ++s) {
      joined_sides += joined[mesh_.slot_arc[s]];
    }
  }
  outcome.euler = static_cast<int>(positions_.size() + joined_sides / 2) - static_cast<int>(rims);
  if (outcome.euler > 1 || triangles_.empty()) return outcome;
  if (limits.hopeless) return outcome;
  align(first.size(), glue);
  if (limits.unrolls && outcome.euler == 1 && fits_unrolled(outcome)) {
    TrialLimits shape = limits;
    shape.solidity = std::min(limits.solidity, kUnrolledFill);
    shape.fill = std::min(limits.fill, kUnrolledFill);
    find_border(joined);
    outcome.accepted = shape_fits(shape, 0, outcome) && !border_crosses();
    return outcome;
  }
  find_border(joined);
  if (!unrolled()) {
    if (!shape_fits(limits, kShapeChange, outcome)) return outcome;
    const Start start = judge_start(std::min(first.size(), second.size()), limits, outcome);
    if (start == Start::hopeless) return outcome;
    if (start == Start::open && !descend(limits, outcome)) return outcome;
  }
  outcome.accepted =
      stretch_fits(limits, outcome) && shape_fits(limits, 0, outcome) && !border_crosses();
  return outcome;
}

void Trial::commit() {
  for (std::uint32_t c = 0; c < cells_.size(); ++c) {
    uv_.centre[cells_[c]] = uvs_[c];
    const CoarseCell& cell = mesh_.cells[cells_[c]];
    for (std::uint32_t s = cell.first_slot; s < cell.first_slot + cell.slot_count; ++s) {
      uv_.slot[s] = uvs_[slot_vertex_[s]];
    }
  }
}

}  // namespace atlas
