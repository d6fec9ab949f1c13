#include "libatlas/param/relaxing/relax.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "libatlas/core/sort_total.h"

namespace atlas::param {

namespace {

// The weight of a spared triangle's symmetric Dirichlet energy. It is small against the energy of
// triangles far beyond a bound of 1.25, but keeps the triangle from vanishing.
constexpr double spared_weight = 1e5;
constexpr VertexStar::Kind spared_energy{VertexEnergy::symmetric_dirichlet};

// The stiffness of a spring. For a vertex among equilateral triangles near an isometry, the
// symmetric Dirichlet energy has a stiffness of about 28, so springs prevail.
constexpr double spring_stiffness = 200;

// When springs pull some vertices, others move only after a neighbour has moved by more than this
// share of a mean triangle's size: this saves a fifth to a third of the time. With three times as
// much, charts end beyond their bound (measured).
constexpr double still_step = 0.003;
// The same while the largest stretch is lowered: this saves a quarter of the time of noisy meshes.
constexpr double still_tail_step = 0.01;

}  // namespace

Jacobian Relaxer::jacobian(std::uint32_t t) const {
  Element room;
  const Element& e = elements_.at(t, room);
  return e.jacobian(to_glm(uvs_[e.v[0]]), to_glm(uvs_[e.v[1]]), to_glm(uvs_[e.v[2]]));
}

void Relaxer::gather(std::span<const std::uint32_t> seeds, int rings) {
  vertices_.clear();
  triangles_.clear();
  const auto take_vertex = [&](std::uint32_t v) {
    if (!vertex_in_[v]) vertices_.push_back(v);
    vertex_in_[v] = 1;
  };
  for (const std::uint32_t t : seeds) {
    for (const std::uint32_t v : elements_[t].v) take_vertex(v);
  }
  std::size_t begin = 0;
  for (int ring = 0; ring < rings; ++ring) {
    const std::size_t end = vertices_.size();
    for (; begin < end; ++begin) {
      const std::uint32_t v = vertices_[begin];
      for (std::uint32_t i = corners_->first[v]; i < corners_->first[v + 1]; ++i) {
        for (const std::uint32_t w : elements_[corners_->corner[i] / 3].v) take_vertex(w);
      }
    }
  }
  for (const std::uint32_t v : vertices_) {
    for (std::uint32_t i = corners_->first[v]; i < corners_->first[v + 1]; ++i) {
      const std::uint32_t t = corners_->corner[i] / 3;
      if (!triangle_in_[t]) triangles_.push_back(t);
      triangle_in_[t] = 1;
    }
  }
  for (const std::uint32_t v : vertices_) vertex_in_[v] = 0;
  mean_area_ = 0;
  for (const std::uint32_t t : triangles_) {
    triangle_in_[t] = 0;
    mean_area_ += elements_[t].area();
  }
  mean_area_ /= static_cast<double>(std::max<std::size_t>(triangles_.size(), 1));
}

void Relaxer::load_vertex(std::uint32_t v) {
  star_.clear();
  spared_star_.clear();
  spring_ = !spring_of_.empty() && spring_of_[v] > 0 ? &springs_[spring_of_[v] - 1] : nullptr;
  if (spring_) offset_ = to_glm(uvs_[v]) - to_glm(spring_->target);
  const bool sparing = energy_ == VertexEnergy::high_power;
  for (std::uint32_t i = corners_->first[v]; i < corners_->first[v + 1]; ++i) {
    const std::uint32_t t = corners_->corner[i] / 3, k = corners_->corner[i] % 3;
    Element room;
    const Element& e = elements_.at(t, room);
    const std::array uvs{to_glm(uvs_[e.v[0]]), to_glm(uvs_[e.v[1]]), to_glm(uvs_[e.v[2]])};
    const double weight = e.area() + 0.1 * mean_area_;  // the second term gives slivers some weight
    if (sparing && spared_[t]) {
      spared_star_.add(e, k, uvs, weight * spared_weight);
    } else {
      star_.add(e, k, uvs, weight);
    }
  }
  star_.finish();
  spared_star_.finish();
}

double Relaxer::energy(glm::dvec2 m) const {
  double sum = star_.energy({energy_, epsilon_}, m);
  if (!spared_star_.empty()) sum += spared_star_.energy(spared_energy, m);
  if (spring_) sum += spring_stiffness * glm::dot(offset_ + m, offset_ + m);
  return sum;
}

// Newton's step, with the Hessian's eigenvalues made positive.
glm::dvec2 Relaxer::newton_step() const {
  VertexStar::Derivatives s = star_.derivatives({energy_, epsilon_});
  if (!spared_star_.empty()) {
    const VertexStar::Derivatives spared = spared_star_.derivatives(spared_energy);
    s.gradient += spared.gradient;
    s.xx += spared.xx;
    s.xy += spared.xy;
    s.yy += spared.yy;
  }
  if (spring_) {
    s.gradient += 2 * spring_stiffness * offset_;
    s.xx += 2 * spring_stiffness;
    s.yy += 2 * spring_stiffness;
  }
  const double mean = 0.5 * (s.xx + s.yy), half = 0.5 * (s.xx - s.yy);
  const double radius = std::sqrt(half * half + s.xy * s.xy);
  const double floor = 1e-6 * (std::abs(mean) + radius);
  const double high = std::max(std::abs(mean + radius), floor);
  const double low = std::max(std::abs(mean - radius), floor);
  if (!(high > 0)) return glm::dvec2(0);
  glm::dvec2 axis(1, 0);  // eigenvector of mean + radius
  if (radius > 0) {
    axis = half > 0 ? glm::dvec2(half + radius, s.xy) : glm::dvec2(s.xy, radius - half);
    axis /= glm::length(axis);
  }
  const glm::dvec2 other(-axis.y, axis.x);
  return -(axis * (glm::dot(axis, s.gradient) / high) +
           other * (glm::dot(other, s.gradient) / low));
}

void Relaxer::wake_around(std::uint32_t v) {
  for (std::uint32_t i = corners_->first[v]; i < corners_->first[v + 1]; ++i) {
    for (const std::uint32_t w : elements_[corners_->corner[i] / 3].v) awake_[w] = 1;
  }
}

double Relaxer::sweep() {
  const double still = energy_ == VertexEnergy::high_power ? still_tail_step : still_step;
  const double still_squared = still * still * mean_area_;
  double gain = 0;
  for (const std::uint32_t v : vertices_) {
    if (!awake_.empty() && !std::exchange(awake_[v], std::uint8_t{0})) continue;
    load_vertex(v);
    const glm::dvec2 step = newton_step();
    double length = 1;
    if (energy_ != VertexEnergy::untangling) {
      length = std::min(star_.share_within(step), spared_star_.share_within(step));
    }
    const double before = energy(glm::dvec2(0));
    for (int halving = 0; halving < 12; ++halving, length *= 0.5) {
      const double after = energy(step * length);
      if (!(after < before)) continue;
      gain += before - after;
      const bool moves = length * length * glm::dot(step, step) > still_squared;
      if (moves && !awake_.empty()) wake_around(v);
      uvs_[v] = {uvs_[v].x + length * step.x, uvs_[v].y + length * step.y};
      break;
    }
  }
  return gain;
}

double Relaxer::least_determinant() const {
  double least = std::numeric_limits<double>::infinity();
  for (const std::uint32_t t : triangles_) least = std::min(least, jacobian(t).det());
  return least;
}

// Untangles the neighbourhood. Returns whether all of its triangles are positive in the end.
bool Relaxer::untangle(int sweeps) {
  constexpr double clearly = 1e-3;
  // Neighbourhoods that became positive in the end had improved by this share at half-time
  // (measured).
  constexpr double half_time_gain = 0.05;
  double start = 0;
  energy_ = VertexEnergy::untangling;
  for (int i = 0; i < sweeps; ++i) {
    const double least = least_determinant();
    if (least >= clearly) return true;
    if (i == 0) start = least;
    if (i == sweeps / 2 && least < 0 && least < (1 - half_time_gain) * start) return false;
    epsilon_ = std::sqrt(1e-4 + 0.04 * std::min(least, 0.0) * std::min(least, 0.0));
    sweep();
  }
  return least_determinant() > 0;
}

void Relaxer::begin(ElementView elements, const CornerLists& corners, std::span<Vec2d> uvs) {
  elements_ = elements;
  corners_ = &corners;
  uvs_ = uvs;
  vertex_in_.assign(uvs.size(), 0);
  triangle_in_.assign(elements.size(), 0);
}

void Relaxer::pull(ElementView elements, const CornerLists& corners, const Pull& pull,
                   std::span<Vec2d> uvs) {
  const std::span<const Spring> springs = pull.springs;
  begin(elements, corners, uvs);
  springs_ = springs;
  spring_of_.assign(uvs.size(), 0);
  std::vector<std::uint32_t> seeds;
  for (std::uint32_t i = 0; i < springs.size(); ++i) {
    const std::uint32_t v = springs[i].vertex;
    spring_of_[v] = i + 1;
    seeds.push_back(corners.corner[corners.first[v]] / 3);
  }
  gather(seeds, pull.rings);
  energy_ = VertexEnergy::symmetric_dirichlet;
  awake_.assign(uvs.size(), 0);
  for (const Spring& s : springs) wake_around(s.vertex);
  double best = 0;
  for (int i = 0; i < pull.sweeps; ++i) {
    const double gain = sweep();
    if (gain < pull.least_gain * best) break;
    best = std::max(best, gain);
  }
  spring_of_.clear();
  awake_.clear();
}

// Around an inner vertex, the last corner of each triangle is the next one of another.
bool Relaxer::on_border(std::uint32_t v) const {
  std::uint64_t next = 0, last = 0;
  for (std::uint32_t i = corners_->first[v]; i < corners_->first[v + 1]; ++i) {
    const auto& triangle = elements_[corners_->corner[i] / 3].v;
    const std::uint32_t k = corners_->corner[i] % 3;
    next += triangle[(k + 1) % 3];
    last += triangle[(k + 2) % 3];
  }
  return next != last;
}

void Relaxer::smooth(ElementView elements, const CornerLists& corners, const Places& places,
                     std::span<Vec2d> uvs) {
  constexpr int rings = 2, sweeps = 8;
  begin(elements, corners, uvs);
  gather(places.triangles, rings);
  if (!places.border_moves) std::erase_if(vertices_, [&](std::uint32_t v) { return on_border(v); });
  energy_ = VertexEnergy::symmetric_dirichlet;
  for (int i = 0; i < sweeps; ++i) sweep();
}

bool Relaxer::settle(ElementView elements, const CornerLists& corners,
                     std::span<const std::uint32_t> vertices, std::span<Vec2d> uvs) {
  constexpr int untangling_sweeps = 40, sweeps = 30;
  constexpr double least_gain = 1e-4;  // of the best sweep's
  begin(elements, corners, uvs);
  vertices_.assign(vertices.begin(), vertices.end());
  triangles_.resize(elements.size());
  std::iota(triangles_.begin(), triangles_.end(), 0u);
  mean_area_ = 0;
  for (std::size_t t = 0; t < elements.size(); ++t) mean_area_ += elements[t].area();
  mean_area_ /= double(std::max<std::size_t>(elements.size(), 1));
  if (!(least_determinant() > 0) && !untangle(untangling_sweeps)) return false;
  energy_ = VertexEnergy::symmetric_dirichlet;
  double best = 0;
  for (int i = 0; i < sweeps; ++i) {
    const double gain = sweep();
    if (!(gain > least_gain * best)) break;
    best = std::max(best, gain);
  }
  return true;
}

void Relaxer::measure_again(std::span<const std::uint32_t> triangles) {
  for (const std::uint32_t t : triangles) {
    const SingularValues s = singular_values(jacobian(t));
    const double area = elements_[t].area();
    sizes_[t] = {area, area * s.large * s.small, s.large, 1 / s.small};
  }
}

// Fills `out` with the triangles stretched beyond `from`. Returns the stretch that 99.9 % of the
// area stays within, or `from` if that is larger.
double Relaxer::find_tail(double from, std::vector<std::uint32_t>& out) {
  double area = 0, uv_area = 0;
  for (const Sizes& s : sizes_) {
    area += s.area;
    uv_area += s.uv_area;
  }
  const double scale = uv_area > 0 ? std::sqrt(area / uv_area) : 1, inverse = 1 / scale;
  out.clear();
  ranked_.clear();
  stretch_.resize(sizes_.size());
  for (std::uint32_t t = 0; t < sizes_.size(); ++t) {
    const Sizes& s = sizes_[t];
    stretch_[t] = std::max(s.large * scale, s.inverse_small * inverse);
    if (!(stretch_[t] > from)) continue;
    out.push_back(t);
    ranked_.push_back({stretch_[t], s.area});
  }
  ranked_.push_back({from, area});
  return value_above_budget(ranked_, 0.001 * area);
}

void Relaxer::spare_worst(double bound, std::vector<std::uint32_t> tail) {
  constexpr double share = 0.0009;  // of the area; the rest of 0.1 % is for what stays just beyond
  spared_.assign(elements_.size(), 0);
  double budget = 0;
  for (std::size_t t = 0; t < elements_.size(); ++t) budget += share * elements_[t].area();
  sort_total(tail.begin(), tail.end(), [&](std::uint32_t a, std::uint32_t b) {
    return stretch_[a] != stretch_[b] ? stretch_[a] > stretch_[b] : a < b;
  });
  for (const std::uint32_t t : tail) {
    if (stretch_[t] <= bound) break;
    if (elements_[t].area() > budget) continue;
    budget -= elements_[t].area();
    spared_[t] = 1;
    for (const std::uint32_t v : elements_[t].v) awake_[v] = 1;
  }
}

Tail Relaxer::lower_tail(ElementView elements, const CornerLists& corners, double bound,
                         std::span<Vec2d> uvs) {
  constexpr int rounds = 12, rings = 2, sweeps = 4, patience = 2;
  // Triangles that are nearly as bad move as well. A longer tail is not limited to a few places.
  constexpr double near = 0.97, longest_share = 0.05, least_gain = 1e-3;
  begin(elements, corners, uvs);
  awake_.assign(uvs.size(), 1);
  std::vector<std::uint32_t> tail(elements.size());
  std::iota(tail.begin(), tail.end(), 0);
  sizes_.resize(elements.size());
  measure_again(tail);
  double now = find_tail(near * bound, tail), best = now;
  best_.assign(uvs.begin(), uvs.end());
  const auto longest = static_cast<std::size_t>(longest_share * double(elements.size()));
  bool wide = false;
  int idle = 0;
  for (int round = 0; round < rounds && now > bound && idle < patience; ++round) {
    wide = tail.size() > longest;
    if (wide) break;
    spare_worst(bound, tail);
    gather(tail, rings);
    energy_ = VertexEnergy::high_power;
    for (int i = 0; i < sweeps; ++i) sweep();
    measure_again(triangles_);
    now = find_tail(near * bound, tail);
    idle = now < best - least_gain ? 0 : idle + 1;
    if (now >= best) continue;
    best = now;
    best_.assign(uvs.begin(), uvs.end());
  }
  std::copy(best_.begin(), best_.end(), uvs.begin());
  awake_.clear();
  if (best <= bound) return Tail::lowered;
  return wide ? Tail::wide : Tail::left;
}

Relaxer::Outcome Relaxer::remove_flips(ElementView elements, const CornerLists& corners, bool holed,
                                       std::span<Vec2d> uvs) {
  constexpr int largest_ring = 16, untangling_sweeps = 40, smoothing_sweeps = 8;
  // If more flips are left after the first rings, as a number and as a share of the triangles, the
  // chart is folded as a whole, which wider rings never undid (measured on charts of some
  // thousands).
  constexpr std::size_t most_left = 64, most_left_share = 200;
  // In a mesh with holes, the search ends if a ring leaves more than this share of the flips: folds
  // there are seldom undone, and wider rings undid 2 of the 46 where one had left more (measured on
  // 130 meshes).
  constexpr double least_undone = 0.8;
  begin(elements, corners, uvs);
  std::vector<std::uint32_t> seeds;
  const auto find = [&] {
    for (std::uint32_t t = 0; t < elements.size(); ++t) {
      if (!(jacobian(t).det() > 0)) seeds.push_back(t);
    }
  };
  find();
  const std::uint32_t flipped = static_cast<std::uint32_t>(seeds.size());
  Outcome out;
  out.left = flipped;
  for (int rings = 1; rings <= largest_ring && !seeds.empty(); rings *= 2) {
    gather(seeds, rings);
    if (untangle(untangling_sweeps)) {
      // Spreads the distortion of the few triangles over more of them.
      gather(seeds, rings + 3);
      energy_ = VertexEnergy::symmetric_dirichlet;
      for (int i = 0; i < smoothing_sweeps; ++i) sweep();
    }
    const double most = least_undone * static_cast<double>(out.left);
    seeds.clear();
    find();
    out.left = static_cast<std::uint32_t>(seeds.size());
    if (out.left > std::max(most_left, elements.size() / most_left_share)) break;
    if (holed && out.left > most) break;
  }
  out.turned = flipped > out.left ? flipped - out.left : 0;
  return out;
}

}  // namespace atlas::param
