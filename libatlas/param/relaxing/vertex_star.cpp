#include "libatlas/param/relaxing/vertex_star.h"

#include <algorithm>
#include <span>

#include "libatlas/param/relaxing/vertex_energy.h"

// Quads never leave this file, so how they are passed does not matter.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace atlas::param {

// Each kernel exists once for processors with wide vectors and once for others.
struct VertexStar::Kernels {
  using Groups = std::span<const Terms>;

  ATLAS_INLINE static double sum(const Quad& q) { return (q[0] + q[2]) + (q[1] + q[3]); }

  ATLAS_INLINE static Terms terms_of(const Shapes& s) {
    const auto quad = [](const double(&from)[lanes]) __attribute__((always_inline)) {
      return *reinterpret_cast<const QuadInPlace*>(from);
    };
    const Quad l = 1 / quad(s.length), h = 1 / quad(s.altitude), foot = quad(s.foot);
    const Quad xx = quad(s.x1) * l, xy = quad(s.y1) * l;  // the Jacobian's columns x and y
    const Quad yx = (quad(s.x2) - xx * foot) * h, yy = (quad(s.y2) - xy * foot) * h;
    const Quad gx = quad(s.of_first) * l;
    const Quad gy = (quad(s.of_second) - quad(s.of_first) * foot * l) * h;
    Terms t;
    t.f = (xx * xx + xy * xy) + (yx * yx + yy * yy);
    t.d = xx * yy - xy * yx;
    t.q = gx * gx + gy * gy;
    t.weight = quad(s.weight);
    t.ax = xx * gx + yx * gy;
    t.ay = xy * gx + yy * gy;
    t.nx = gx * yy - gy * xy;
    t.ny = gy * xx - gx * yx;
    return t;
  }

  template <class Energy>
  ATLAS_INLINE static double sum_of(Groups groups, glm::dvec2 m, const Energy& energy) {
    const double squared = glm::dot(m, m);
    Quad total{};
    for (const Terms& t : groups) {
      const Quad f = t.f + 2 * (t.ax * m.x + t.ay * m.y) + t.q * squared;
      const Quad d = t.d + (t.nx * m.x + t.ny * m.y);
      total += t.weight * energy(f, d);
    }
    return sum(total);
  }

  ATLAS_INLINE static double energy(Groups groups, const Kind& kind, glm::dvec2 m) {
    switch (kind.energy) {
      case VertexEnergy::untangling:
        return sum_of(
            groups, m, [&](const Quad& f, const Quad& d) __attribute__((always_inline)) {
              return untangling(f, d, kind.epsilon);
            });
      case VertexEnergy::symmetric_dirichlet:
        return sum_of(
            groups, m, [](const Quad& f, const Quad& d) __attribute__((always_inline)) {
              return symmetric_dirichlet(f, d);
            });
      case VertexEnergy::high_power:
        return sum_of(
            groups, m, [](const Quad& f, const Quad& d) __attribute__((always_inline)) {
              return high_power(f, d);
            });
    }
    return 0;
  }

  template <class Partials>
  ATLAS_INLINE static Derivatives sum_derivatives(Groups groups, const Partials& partials) {
    Quad gx{}, gy{}, xx{}, xy{}, yy{};
    for (const Terms& t : groups) {
      const EnergyDerivatives<Quad> p = partials(t.f, t.d);
      const Quad fx = 2 * t.ax, fy = 2 * t.ay, even = 2 * p.f * t.q;
      gx += t.weight * (p.f * fx + p.d * t.nx);
      gy += t.weight * (p.f * fy + p.d * t.ny);
      xx += t.weight * (even + p.dd * t.nx * t.nx + 2 * p.fd * fx * t.nx + p.ff * fx * fx);
      yy += t.weight * (even + p.dd * t.ny * t.ny + 2 * p.fd * fy * t.ny + p.ff * fy * fy);
      xy += t.weight * (p.dd * t.nx * t.ny + p.fd * (fx * t.ny + fy * t.nx) + p.ff * fx * fy);
    }
    return {{sum(gx), sum(gy)}, sum(xx), sum(xy), sum(yy)};
  }

  ATLAS_INLINE static Derivatives derivatives(Groups groups, const Kind& kind) {
    switch (kind.energy) {
      case VertexEnergy::untangling:
        return sum_derivatives(
            groups, [&](const Quad& f, const Quad& d) __attribute__((always_inline)) {
              return untangling_derivatives(f, d, kind.epsilon);
            });
      case VertexEnergy::symmetric_dirichlet:
        return sum_derivatives(
            groups, [](const Quad& f, const Quad& d) __attribute__((always_inline)) {
              return symmetric_dirichlet_derivatives(f, d);
            });
      case VertexEnergy::high_power:
        return sum_derivatives(
            groups, [](const Quad& f, const Quad& d)
                        __attribute__((always_inline)) { return high_power_derivatives(f, d); });
    }
    return {};
  }

  ATLAS_INLINE static double share_within(Groups groups, glm::dvec2 step) {
    constexpr double most = 0.8, whole = 1;
    Quad least = whole + Quad{};
    for (const Terms& t : groups) {
      const Quad rate = t.nx * step.x + t.ny * step.y, share = -most * t.d / rate;
      const Quad none = whole + Quad{};
      const Quad own = rate < 0 ? share : none;
      least = own < least ? own : least;
    }
    return std::min(std::min(least[0], least[1]), std::min(least[2], least[3]));
  }

  static void terms_narrow(std::span<const Shapes> from, std::span<Terms> to) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = terms_of(from[i]);
  }
  ATLAS_WIDE static void terms_wide(std::span<const Shapes> from, std::span<Terms> to) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = terms_of(from[i]);
  }
  static double energy_narrow(Groups g, const Kind& kind, glm::dvec2 m) {
    return energy(g, kind, m);
  }
  ATLAS_WIDE static double energy_wide(Groups g, const Kind& kind, glm::dvec2 m) {
    return energy(g, kind, m);
  }
  static Derivatives derivatives_narrow(Groups g, const Kind& kind) { return derivatives(g, kind); }
  ATLAS_WIDE static Derivatives derivatives_wide(Groups g, const Kind& kind) {
    return derivatives(g, kind);
  }
};

void VertexStar::add(const Element& element, std::uint32_t corner,
                     const std::array<glm::dvec2, 3>& uvs, double weight) {
  // Fills the unused lanes of the last group: a right-angled triangle that does not move and has no
  // weight.
  static constexpr Shapes none{{1, 1, 1, 1}, {}, {1, 1, 1, 1}, {}, {1, 1, 1, 1},
                               {},           {}, {1, 1, 1, 1}, {}, {}};
  const std::size_t group = size_ / lanes, lane = size_ % lanes;
  if (group == shapes_.size()) shapes_.emplace_back();
  Shapes& s = shapes_[group];
  if (lane == 0) s = none;
  const glm::dvec2 first = uvs[1] - uvs[0], second = uvs[2] - uvs[0];
  s.length[lane] = element.length;
  s.foot[lane] = element.foot;
  s.altitude[lane] = element.altitude;
  s.weight[lane] = weight;
  s.x1[lane] = first.x;
  s.y1[lane] = first.y;
  s.x2[lane] = second.x;
  s.y2[lane] = second.y;
  s.of_first[lane] = corner == 0 ? -1 : corner == 1;
  s.of_second[lane] = corner == 0 ? -1 : corner == 2;
  ++size_;
}

void VertexStar::finish() {
  terms_.resize((size_ + lanes - 1) / lanes);
  has_wide_vectors ? Kernels::terms_wide(shapes_, terms_) : Kernels::terms_narrow(shapes_, terms_);
}

double VertexStar::energy(const Kind& kind, glm::dvec2 m) const {
  return has_wide_vectors ? Kernels::energy_wide(terms_, kind, m)
                          : Kernels::energy_narrow(terms_, kind, m);
}

VertexStar::Derivatives VertexStar::derivatives(const Kind& kind) const {
  return has_wide_vectors ? Kernels::derivatives_wide(terms_, kind)
                          : Kernels::derivatives_narrow(terms_, kind);
}

double VertexStar::share_within(glm::dvec2 step) const {
  return Kernels::share_within(terms_, step);
}

}  // namespace atlas::param
