#include "libatlas/simplify/chart_simplifier.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace atlas::simplify {
namespace {

constexpr float kIdle = std::numeric_limits<float>::infinity();
// A collapse must not give a vertex more neighbours than this. A vertex that has more from the
// start is examined once a run only, and not after each collapse of a neighbour. Without these two
// rules the time would be quadratic.
constexpr std::size_t kHub = 96;
// The number of targets whose bounds are checked before a vertex is left alone.
constexpr std::size_t kAttempts = 4;

float round_up(double x) {
  return static_cast<float>(x * (1 + 1e-6));
}

}  // namespace

ChartSimplifier::ChartSimplifier(const Geometry& geometry, FineChart fine, double texel,
                                 const SlipLimits& limits)
    : fine_(std::move(fine)),
      points_(geometry, fine_),
      texel_(texel),
      limits_(limits),
      mesh_(fine_),
      measure_(fine_, points_),
      face_slip_(fine_.triangle_count(), 0.0F),
      face_turn_(fine_.triangle_count(), 0.0F) {}

void ChartSimplifier::load(std::uint32_t v) {
  Star& star = star_;
  const auto uv_at = [&](std::uint32_t u) { return to_glm(points_.uvs[u]); };
  const auto position_at = [&](std::uint32_t u) { return to_dvec(points_.positions[u]); };
  star.vertex = v;
  mesh_.ring(v, star.ring);
  star.uv = uv_at(v);
  star.position = position_at(v);
  star.uvs.clear();
  star.positions.clear();
  for (const std::uint32_t u : star.ring.vertices) {
    star.uvs.push_back(uv_at(u));
    star.positions.push_back(position_at(u));
  }
  star.measure_faces();
}

bool ChartSimplifier::judge(std::uint32_t v, std::uint32_t w, Estimate& out) {
  load(v);
  const auto& neighbours = star_.ring.vertices;
  const auto at = std::find(neighbours.begin(), neighbours.end(), w);
  if (at == neighbours.end()) return false;
  const std::size_t target = static_cast<std::size_t>(at - neighbours.begin());
  if (star_.ring.border && target != 0 && target + 1 != neighbours.size()) return false;
  return star_.judge(target, texel_, limits_.slip, out);
}

bool ChartSimplifier::check(const BorderStep& border, Collapse& collapse) {
  if (star_.vertex != collapse.v) load(collapse.v);
  const Star& star = star_;
  if (!collapse.outside && collapse.offset > limits_.slip) return false;
  const auto at = std::find(star.ring.vertices.begin(), star.ring.vertices.end(), collapse.w);
  const std::size_t target = static_cast<std::size_t>(at - star.ring.vertices.begin());
  SlipLimits before{border.before, 0};
  for (const std::uint32_t f : star.ring.faces) {
    before.slip = std::max<double>(before.slip, face_slip_[f]);
    before.turn = std::max<double>(before.turn, face_turn_[f]);
  }
  double step = std::max(border.step, star.step_slip(target) / texel_);
  if (!collapse.outside) step = std::max(step, collapse.offset);
  const SlipLimits sum{before.slip + step, before.turn + star.step_turn(target)};
  const bool enough = sum.slip <= limits_.slip && sum.turn <= limits_.turn;
  const SlipLimits limits{limits_.slip * texel_, limits_.turn};
  collapse.faces.clear();
  collapse.bounds.clear();
  for (std::size_t i = 0; i < star.ring.faces.size(); ++i) {
    if (!star.keeps(i, target)) continue;
    SlipLimits found = sum;
    if (!enough) {
      if (!measure_.measure({collapse.w, star.ring.vertices[i], star.ring.vertices[star.after(i)]},
                            limits, found)) {
        return false;
      }
      found.slip /= texel_;
    }
    collapse.faces.push_back(star.ring.faces[i]);
    collapse.bounds.push_back(found);
  }
  return !grows_hub(collapse) && mesh_.can_collapse(collapse.v, collapse.w);
}

bool ChartSimplifier::grows_hub(const Collapse& collapse) const {
  const std::size_t neighbours = star_.size();
  if (neighbours <= 4) return false;
  const std::size_t now = mesh_.valence(collapse.w, kHub + 1);
  return now + neighbours - 4 > std::max(kHub, now);
}

void ChartSimplifier::wake(std::uint32_t v, float cost) {
  if (key_.empty() || key_[v] != kIdle) return;
  if (mesh_.valence(v, kHub + 1) <= kHub) {
    push(v, cost);
  } else if (!hub_[v]) {
    hub_[v] = true;
    hubs_.push_back(v);
  }
}

void ChartSimplifier::apply(const Collapse& collapse) {
  if (star_.vertex != collapse.v) load(collapse.v);
  mesh_.collapse(collapse.v, collapse.w);
  for (std::size_t i = 0; i < collapse.faces.size(); ++i) {
    face_slip_[collapse.faces[i]] = round_up(collapse.bounds[i].slip);
    face_turn_[collapse.faces[i]] = round_up(collapse.bounds[i].turn);
  }
  for (const std::uint32_t u : star_.ring.vertices) {
    if (fine_.border(u)) {
      touched_.push_back(u);
    } else {
      wake(u, static_cast<float>(collapse.cost));
    }
  }
  star_.vertex = kNoIndex;
}

void ChartSimplifier::push(std::uint32_t v, float cost) {
  key_[v] = cost;
  heap_.push_back({cost, v});
  std::push_heap(heap_.begin(), heap_.end(), costs_more);
}

// Judges the targets of an inner vertex and sorts the possible ones by cost. Returns false if there
// is none.
bool ChartSimplifier::rank(std::uint32_t v) {
  load(v);
  star_.pick_targets(targets_);
  candidates_.clear();
  for (const std::size_t target : targets_) {
    Estimate estimate;
    if (star_.judge(target, texel_, limits_.slip, estimate) && estimate.offset <= limits_.slip) {
      candidates_.push_back(estimate);
    }
  }
  std::sort(candidates_.begin(), candidates_.end(), [](const Estimate& a, const Estimate& b) {
    return a.cost != b.cost ? a.cost < b.cost : a.w < b.w;
  });
  return !candidates_.empty();
}

void ChartSimplifier::queue_all() {
  key_.assign(fine_.vertex_count(), kIdle);
  hub_.assign(fine_.vertex_count(), false);
  for (std::uint32_t v = 0; v < fine_.vertex_count(); ++v) {
    if (fine_.border(v) || !rank(v)) continue;
    key_[v] = static_cast<float>(candidates_[0].cost);
    heap_.push_back({key_[v], v});
  }
  std::make_heap(heap_.begin(), heap_.end(), costs_more);
}

void ChartSimplifier::process(std::uint32_t v, float cost) {
  if (!rank(v)) return;
  const float fresh = static_cast<float>(candidates_[0].cost);
  if (fresh > cost && fresh > top_cost()) {
    push(v, fresh);
    return;
  }
  for (std::size_t i = 0; i < std::min(candidates_.size(), kAttempts); ++i) {
    static_cast<Estimate&>(attempt_) = candidates_[i];
    if (check({}, attempt_)) {
      apply(attempt_);
      return;
    }
  }
}

void ChartSimplifier::run(double limit, const Context& context) {
  if (key_.empty() && fine_.vertex_count() > 0) queue_all();
  for (const std::uint32_t v : std::exchange(hubs_, {})) {
    hub_[v] = false;
    if (mesh_.vertex_alive(v) && key_[v] == kIdle) push(v, 0.0F);
  }
  for (std::size_t steps = 0; !heap_.empty() && heap_.front().cost <= limit; ++steps) {
    if (steps % 256 == 0 && context.cancelled()) return;
    const Entry top = heap_.front();
    std::pop_heap(heap_.begin(), heap_.end(), costs_more);
    heap_.pop_back();
    if (key_[top.vertex] != top.cost || !mesh_.vertex_alive(top.vertex)) continue;
    key_[top.vertex] = kIdle;
    process(top.vertex, top.cost);
  }
}

double ChartSimplifier::top_cost() const {
  return heap_.empty() ? kIdle : heap_.front().cost;
}

double ChartSimplifier::next_cost() const {
  return hubs_.empty() ? top_cost() : 0;
}

std::vector<std::uint32_t> ChartSimplifier::take_touched() {
  std::sort(touched_.begin(), touched_.end());
  touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
  return std::exchange(touched_, {});
}

void ChartSimplifier::collect(std::vector<Triangle>& out) const {
  for (std::uint32_t f = 0; f < fine_.triangle_count(); ++f) {
    if (!mesh_.face_alive(f)) continue;
    const auto c = mesh_.corners(f);
    out.push_back({{c[0], c[1], c[2]}, fine_.source[f]});
  }
}

SlipLimits ChartSimplifier::worst() const {
  SlipLimits worst;
  for (std::uint32_t f = 0; f < fine_.triangle_count(); ++f) {
    if (!mesh_.face_alive(f)) continue;
    worst.slip = std::max<double>(worst.slip, face_slip_[f]);
    worst.turn = std::max<double>(worst.turn, face_turn_[f]);
  }
  return worst;
}

}  // namespace atlas::simplify
