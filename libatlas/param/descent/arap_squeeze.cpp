#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/param/descent/arap_solver.h"
#include "libatlas/param/mesh/percentile.h"

namespace atlas::param {
namespace {

// The mean of the 12th power of the stretch approximates its maximum; powers of 4, 6 and 8 reach
// less. Weights, the 10th power of the stretch, settle if damped by an eighth, and oscillate if
// damped by a half (measured). So damped, roots suffice: logarithms took a sixth of the stage.
double damped_weight(double weight, double stretch) {
  const double root_8 = std::sqrt(std::sqrt(std::sqrt(weight)));
  return weight / root_8 * stretch * std::sqrt(std::sqrt(stretch));
}
// Stretch is compared, and extrapolated, as this, which is nearly its logarithm.
double rise(double stretch) {
  return 2 * (stretch - 1) / (stretch + 1);
}
// Lengths of steps, relative to the step to the minimum for the current weights and rotations. With
// these the stretch falls further than with plain steps (measured on 240 meshes).
constexpr std::array steps{1.7, 1.3};

// The least weight relative to the largest: initially, and its factor in each iteration. Without a
// least weight, flat faces of CAD parts stretched by a tenth for the sake of a chamfer between
// them, where a hundredth is enough. With it and the following limits L2 - 1 is 14 % less, with a
// hundredth fewer charts (347 meshes).
constexpr double least_weight = 0.4, less_each_time = 0.75;
// If the bound is not near, it is lowered down to last_weight: a triangle of that weight still
// keeps its shape where that costs nothing.
constexpr double less_when_slow = 0.3, last_weight = 0.02;
constexpr int easing_steps = 3;
constexpr double rounding = 1e-4;  // margin kept to the bound when moving back, as rise()

// The decrease of stretch in an iteration is a share of that in the one before, which is estimated
// from two iterations. In charts of at least many_triangles, whose iterations take long, this ended
// a third of the futile iterations, and 25 of 360 others (measured on 240 meshes). In smaller
// charts it would end more of the others and save less.
constexpr std::size_t many_triangles = 2000;
constexpr double least_share = 0.6, most_share = 0.9;

// Whether a value that fell from `two_ago` to `one_ago` and `now` will end above the bound.
bool ends_above(double bound, double two_ago, double one_ago, double now) {
  const double before = two_ago - one_ago, last = one_ago - now;
  const double share = before > 0 ? std::clamp(last / before, least_share, most_share) : most_share;
  const double next = share * (last > 0 ? last : 0.5 * before);
  return now - next / (1 - share) > bound;
}

}  // namespace

// Fills w_.stretch with rise(max(s1, 1/s2)) at the chosen scale. Returns the value that 99.9 % of
// the area stays within.
double ArapSolver::update_stretch(std::span<const Vec2d> uvs, bool ratio) {
  constexpr double worst = 10;  // for flipped triangles
  double area = 0, uv_area = 0, large = 0, small = std::numeric_limits<double>::infinity();
  w_.stretch.resize(w_.elements.size());
  w_.sigma.resize(w_.elements.size());
  for (std::size_t t = 0; t < w_.elements.size(); ++t) {
    const Element e = w_.elements[t];
    const Jacobian j = e.jacobian(to_glm(uvs[e.v[0]]), to_glm(uvs[e.v[1]]), to_glm(uvs[e.v[2]]));
    const SingularValues s = w_.sigma[t] = singular_values(j);
    area += e.area();
    uv_area += e.area() * std::abs(j.det());
    large = std::max(large, s.large);
    if (s.small > 0) small = std::min(small, s.small);
  }
  double scale = uv_area > 0 ? std::sqrt(area / uv_area) : 1;
  if (ratio && small <= large) scale = 1 / std::sqrt(small * large);
  w_.tail.clear();
  for (std::size_t t = 0; t < w_.elements.size(); ++t) {
    const SingularValues s = w_.sigma[t];
    const double r = s.small > 0 ? std::max(s.large * scale, 1 / (s.small * scale)) : worst;
    w_.stretch[t] = rise(std::clamp(r, 1.0, worst));
    w_.tail.push_back({w_.stretch[t], w_.elements[t].area()});
  }
  return upper_percentile(w_.tail, 0.001);
}

// Returns L2 stretch squared minus 1 of the uvs that update_stretch() measured last; infinite with
// flips.
double ArapSolver::stretch_energy() {
  double energy = 0, area = 0, uv_area = 0;
  for (std::size_t t = 0; t < w_.elements.size(); ++t) {
    const auto [large, small] = w_.sigma[t];
    if (!(small > 0)) return std::numeric_limits<double>::infinity();
    const double own = w_.elements[t].area();
    area += own;
    uv_area += own * large * small;
    energy += 0.5 * own * (1 / (large * large) + 1 / (small * small));
  }
  return energy * uv_area / (area * area) - 1;
}

void ArapSolver::weight_by_stretch(double largest, double least) {
  for (std::size_t t = 0; t < w_.elements.size(); ++t) {
    // The worst 0.1 % may stay as it is: more weight on it would only spoil the rest.
    const double r = std::clamp(w_.stretch[t] / largest, 0.05, 1.0);
    const double weight = damped_weight(w_.elements[t].weight, r);
    w_.elements.set_weight(t, static_cast<float>(std::max(least, weight)));
  }
  weighted_ = true;
}

void ArapSolver::squeeze(const Squeeze& options, std::span<Vec2d> uvs) {
  wake(uvs);
  const double bound = rise(options.bound);
  const bool foresees = mesh_.triangles.size() >= many_triangles && !options.ratio;
  const bool chooses = !options.rough && uvs.size() < large_mesh;  // there is memory for more
                                                                   // states
  double now = update_stretch(uvs, options.ratio), best = now, one_ago = now;
  double least = options.rough ? 0 : least_weight;
  w_.best.assign(uvs.begin(), uvs.end());
  if (chooses) w_.unsqueezed = w_.best;
  w_.rotations.resize(w_.elements.size());
  for (int i = 0; i < options.iterations && best > bound; ++i) {
    if (i > 0) least *= less_each_time;
    weight_by_stretch(now, least);
    factorize();
    for (const double times : steps) {
      update(uvs);
      solve_relaxed(times, {fine, fine_share}, uvs);
    }
    now = update_stretch(uvs, options.ratio);
    const double two_ago = std::exchange(one_ago, best);
    if (now < best) {
      w_.best.assign(uvs.begin(), uvs.end());
      best = now;
    }
    // Steps get shorter, though not each one. If the remaining steps, extrapolated from the last
    // two, do not suffice, none will with these least weights.
    const double gain = 0.5 * (two_ago - best);
    const bool slow = (i >= 2 && best - gain * (options.iterations - 1 - i) > bound) ||
                      (i >= 1 && foresees && ends_above(bound, two_ago, one_ago, best));
    if (slow && least < last_weight) break;
    if (slow) least *= less_when_slow;
  }
  if (chooses && best <= bound) {
    ease(bound - rounding, options.ratio, uvs);
  } else {
    std::copy(w_.best.begin(), w_.best.end(), uvs.begin());
  }
}

// Makes uvs the one with the least L2 stretch, within the bound, of w_.best and some blends of it
// with w_.unsqueezed.
void ArapSolver::ease(double bound, bool ratio, std::span<Vec2d> uvs) {
  const auto blend = [&](double share) {
    for (std::size_t v = 0; v < uvs.size(); ++v) {
      const glm::dvec2 from = to_glm(w_.unsqueezed[v]), to = to_glm(w_.best[v]);
      uvs[v] = from_glm(from + share * (to - from));
    }
  };
  blend(0);
  double outside = 0, inside = 1, kept = 1;
  const double stretch_outside = update_stretch(uvs, ratio);
  if (stretch_outside <= bound) return;  // it was within the bound before
  blend(1);
  const double stretch_inside = update_stretch(uvs, ratio);
  double least = stretch_energy();
  for (int i = 0; i < easing_steps; ++i) {
    // First by the secant method, a little on the safe side, then by bisection.
    double at = 0.5 * (outside + inside);
    if (i == 0) {
      const double share = (stretch_outside - bound) / (stretch_outside - stretch_inside);
      at = std::clamp(1.05 * share, 0.1, 0.95);
    }
    blend(at);
    const bool within = update_stretch(uvs, ratio) <= bound;
    (within ? inside : outside) = at;
    const double energy = stretch_energy();
    if (within && energy < least) {
      least = energy;
      kept = at;
    }
  }
  blend(kept);
}

}  // namespace atlas::param
