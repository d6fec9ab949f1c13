#include "libatlas/simplify/chart_simplifier.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/predicates.h"

namespace atlas::simplify {
namespace {

constexpr float kIdle = std::numeric_limits<float>::infinity();
// Weight of an edge's length (texels) against slip (in units of the bound). It spreads the
// vertices of flat parts evenly, and is small enough to leave curved parts to the slip.
constexpr double kLengthWeight = 0.02;
// A needle of quality q costs 1 + kNeedle / q times as much.
constexpr double kNeedle = 0.1;
// No triangle thinner than this arises (1 is equilateral, 0 has no area) where there was none: a
// strip of one to ten thousand still may.
constexpr double kThinnest = 2e-4, kNoArea = 1e-7;
// Around a vertex with many neighbours only the nearest are tried as targets.
constexpr std::size_t kManyNeighbours = 14, kNearest = 8;
// Collapses do not give a vertex more neighbours than this, and a vertex that has more from the
// start is looked at once a run only, not after each of its neighbours' collapses: both would take
// quadratic time.
constexpr std::size_t kHub = 96;
constexpr std::size_t kAttempts = 4;  // targets whose bounds are checked before a vertex rests

// Exactly the sign of the orientation; the plain determinant decides when rounding cannot matter.
bool turns_left(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x);
  const double det = left - right, bound = 4e-16 * (std::abs(left) + std::abs(right));
  if (det > bound) return true;
  if (det < -bound) return false;
  return orientation(from_glm(a), from_glm(b), from_glm(c)) > 0;
}

double cross2(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

double quality(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, double twice_area) {
  const glm::dvec3 x = b - a, y = c - b, z = a - c;
  const double squares = glm::dot(x, x) + glm::dot(y, y) + glm::dot(z, z);
  return squares > 0 ? 3.4641016151377544 * twice_area / squares : 0;
}

float round_up(double x) {
  return static_cast<float>(x * (1 + 1e-6));
}

}  // namespace

// The surroundings of the vertex at hand, fetched once for all its targets.
struct ChartSimplifier::Star {
  Ring ring;
  std::uint32_t vertex = kNone;
  glm::dvec2 uv;
  glm::dvec3 position;
  std::vector<glm::dvec2> uvs;        // of the neighbours
  std::vector<glm::dvec3> positions;  // likewise
  std::vector<glm::dvec3> normals;    // unit, of the faces; 0 where there is no area
  double worst_quality = 1;

  std::size_t size() const { return ring.vertices.size(); }
  std::size_t after(std::size_t i) const { return i + 1 == size() ? 0 : i + 1; }
  bool keeps(std::size_t face, std::size_t target) const {
    return face != target && after(face) != target;
  }
};

ChartSimplifier::ChartSimplifier(const Geometry& geometry, FineChart fine, double texel,
                                 const SlipLimits& limits)
    : geometry_(geometry),
      fine_(std::move(fine)),
      texel_(texel),
      limits_(limits),
      mesh_(fine_),
      measure_(geometry, fine_),
      face_slip_(fine_.triangle_count(), 0.0F),
      face_turn_(fine_.triangle_count(), 0.0F),
      star_(std::make_unique<Star>()) {}

ChartSimplifier::~ChartSimplifier() = default;

void ChartSimplifier::load(std::uint32_t v) {
  Star& star = *star_;
  const auto uv_at = [&](std::uint32_t u) { return to_glm(geometry_.uv(fine_.vertex_uv[u])); };
  const auto position_at = [&](std::uint32_t u) {
    return to_dvec(geometry_.position(fine_.vertex_uv[u]));
  };
  star.vertex = v;
  mesh_.ring(v, star.ring);
  star.uv = uv_at(v);
  star.position = position_at(v);
  star.uvs.clear();
  star.positions.clear();
  star.normals.clear();
  for (const std::uint32_t u : star.ring.vertices) {
    star.uvs.push_back(uv_at(u));
    star.positions.push_back(position_at(u));
  }
  star.worst_quality = 1;
  for (std::size_t i = 0; i < star.ring.faces.size(); ++i) {
    const glm::dvec3 &a = star.positions[i], &b = star.positions[star.after(i)];
    const glm::dvec3 normal = glm::cross(a - star.position, b - star.position);
    const double length = glm::length(normal);
    star.normals.push_back(length > 0 ? normal / length : glm::dvec3(0));
    star.worst_quality = std::min(star.worst_quality, quality(star.position, a, b, length));
  }
}

// Finds the new triangle that holds v's uv, and the gap there.
bool ChartSimplifier::locate(std::size_t target, Estimate& out) const {
  const Star& star = *star_;
  double best = -std::numeric_limits<double>::infinity();
  const glm::dvec2& o = star.uvs[target];
  for (std::size_t i = 0; i < star.ring.faces.size(); ++i) {
    if (!star.keeps(i, target)) continue;
    const std::size_t j = star.after(i);
    const glm::dvec2 a = star.uvs[i] - o, b = star.uvs[j] - o, d = star.uv - o;
    const double det = cross2(a, b), x = cross2(d, b) / det, y = cross2(a, d) / det;
    const double inside = std::min({x, y, 1 - x - y});
    if (inside <= best) continue;
    best = inside;
    const glm::dvec3 &p = star.positions[target], e = star.positions[i] - p,
                     f = star.positions[j] - p;
    out.offset = glm::length(p + x * e + y * f - star.position) / texel_;
  }
  constexpr double kRounding = 1e-9;
  out.outside = star.ring.border && best < -kRounding;
  return best > -std::numeric_limits<double>::infinity();
}

bool ChartSimplifier::judge_target(std::size_t target, Estimate& out) const {
  const Star& star = *star_;
  const glm::dvec2& uv = star.uvs[target];
  const glm::dvec3& position = star.positions[target];
  const double thinnest = std::clamp(star.worst_quality, kNoArea, kThinnest);
  double worst = 1;
  for (std::size_t i = 0; i < star.ring.faces.size(); ++i) {
    if (!star.keeps(i, target)) continue;
    const std::size_t j = star.after(i);
    if (!turns_left(uv, star.uvs[i], star.uvs[j])) return false;
    const glm::dvec3 normal =
        glm::cross(star.positions[i] - position, star.positions[j] - position);
    const double length = glm::length(normal);
    const double q = quality(position, star.positions[i], star.positions[j], length);
    if (q < thinnest || !(length > 0)) return false;
    if (star.normals[i] != glm::dvec3(0) && glm::dot(normal, star.normals[i]) <= 0) return false;
    worst = std::min(worst, q);
  }
  if (!locate(target, out)) return false;  // nothing would be left
  out.v = star.vertex;
  out.w = star.ring.vertices[target];
  const double slip = out.outside ? 0 : out.offset / limits_.slip;
  const double length = kLengthWeight * glm::length(position - star.position) / texel_;
  out.cost = (slip * slip + length * length) * (1 + kNeedle / worst);
  return true;
}

// Largest distance between the surfaces before and after, at the same uv, where an edge that goes
// crosses one that comes. (At the vertex itself it is Collapse::offset.)
double ChartSimplifier::step_slip(std::size_t target) const {
  const Star& star = *star_;
  const std::size_t n = star.size();
  double worst = 0;
  const glm::dvec2 &o = star.uvs[target], go = o - star.uv;
  for (std::size_t j = 0; j < n; ++j) {
    const bool beside = star.after(j) == target || star.after(target) == j;
    const bool new_border = star.ring.border && (j == 0 || j + 1 == n);
    if (j == target || (beside && !new_border)) continue;
    const glm::dvec2 come = star.uvs[j] - o;
    for (std::size_t i = 0; i < n; ++i) {
      if (i == target || i == j) continue;
      const glm::dvec2 go_i = star.uvs[i] - star.uv;
      const double det = cross2(go_i, come);
      if (det == 0) continue;
      const double s = cross2(go, come) / det, t = cross2(go, go_i) / det;
      if (s <= 0 || s >= 1 || t <= 0 || t >= 1) continue;
      const glm::dvec3 before = star.position + s * (star.positions[i] - star.position);
      const glm::dvec3 after =
          star.positions[target] + t * (star.positions[j] - star.positions[target]);
      worst = std::max(worst, glm::length(after - before));
    }
  }
  return worst / texel_;
}

double ChartSimplifier::step_turn(std::size_t target) const {
  const Star& star = *star_;
  double least = 1;
  for (std::size_t i = 0; i < star.ring.faces.size(); ++i) {
    if (!star.keeps(i, target)) continue;
    const glm::dvec3& p = star.positions[target];
    const glm::dvec3 normal =
        glm::normalize(glm::cross(star.positions[i] - p, star.positions[star.after(i)] - p));
    for (const glm::dvec3& old : star.normals) {
      if (old != glm::dvec3(0)) least = std::min(least, glm::dot(normal, old));
    }
  }
  return std::acos(std::max(least, -1.0));
}

bool ChartSimplifier::judge(std::uint32_t v, std::uint32_t w, Estimate& out) {
  load(v);
  const auto& neighbours = star_->ring.vertices;
  const auto at = std::find(neighbours.begin(), neighbours.end(), w);
  if (at == neighbours.end()) return false;
  const std::size_t target = static_cast<std::size_t>(at - neighbours.begin());
  if (star_->ring.border && target != 0 && target + 1 != neighbours.size()) return false;
  return judge_target(target, out);
}

bool ChartSimplifier::check(const BorderStep& border, Collapse& collapse) {
  if (star_->vertex != collapse.v) load(collapse.v);
  const Star& star = *star_;
  if (!collapse.outside && collapse.offset > limits_.slip) return false;
  const auto at = std::find(star.ring.vertices.begin(), star.ring.vertices.end(), collapse.w);
  const std::size_t target = static_cast<std::size_t>(at - star.ring.vertices.begin());
  SlipLimits before{border.before, 0};
  for (const std::uint32_t f : star.ring.faces) {
    before.slip = std::max<double>(before.slip, face_slip_[f]);
    before.turn = std::max<double>(before.turn, face_turn_[f]);
  }
  double step = std::max(border.step, step_slip(target));
  if (!collapse.outside) step = std::max(step, collapse.offset);
  const SlipLimits sum{before.slip + step, before.turn + step_turn(target)};
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
  const std::size_t neighbours = star_->size();
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
  if (star_->vertex != collapse.v) load(collapse.v);
  mesh_.collapse(collapse.v, collapse.w);
  for (std::size_t i = 0; i < collapse.faces.size(); ++i) {
    face_slip_[collapse.faces[i]] = round_up(collapse.bounds[i].slip);
    face_turn_[collapse.faces[i]] = round_up(collapse.bounds[i].turn);
  }
  for (const std::uint32_t u : star_->ring.vertices) {
    if (fine_.border(u)) {
      touched_.push_back(u);
    } else {
      wake(u, static_cast<float>(collapse.cost));
    }
  }
  star_->vertex = kNone;
}

void ChartSimplifier::push(std::uint32_t v, float cost) {
  key_[v] = cost;
  heap_.push_back({cost, v});
  std::push_heap(heap_.begin(), heap_.end(), [](const Entry& a, const Entry& b) {
    return a.cost != b.cost ? a.cost > b.cost : a.vertex > b.vertex;
  });
}

void ChartSimplifier::pick_targets(std::vector<std::size_t>& out) const {
  const Star& star = *star_;
  out.clear();
  for (std::size_t i = 0; i < star.size(); ++i) out.push_back(i);
  if (out.size() <= kManyNeighbours) return;
  const auto distance = [&](std::size_t i) {
    const glm::dvec3 d = star.positions[i] - star.position;
    return glm::dot(d, d);
  };
  std::partial_sort(out.begin(), out.begin() + kNearest, out.end(),
                    [&](std::size_t a, std::size_t b) {
                      const double x = distance(a), y = distance(b);
                      return x != y ? x < y : a < b;
                    });
  out.resize(kNearest);
}

// Judges all targets of an inner vertex and sorts the possible ones by cost.
bool ChartSimplifier::rank(std::uint32_t v) {
  load(v);
  pick_targets(targets_);
  candidates_.clear();
  for (const std::size_t target : targets_) {
    Estimate estimate;
    if (judge_target(target, estimate) && estimate.offset <= limits_.slip) {
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
  std::make_heap(heap_.begin(), heap_.end(), [](const Entry& a, const Entry& b) {
    return a.cost != b.cost ? a.cost > b.cost : a.vertex > b.vertex;
  });
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
    std::pop_heap(heap_.begin(), heap_.end(), [](const Entry& a, const Entry& b) {
      return a.cost != b.cost ? a.cost > b.cost : a.vertex > b.vertex;
    });
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
