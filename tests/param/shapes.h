// Discs whose best flattening is known, and discs that are hard to flatten.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "libatlas/param/local_mesh.h"

namespace atlas::testing {

struct Disc {
  std::vector<Vec3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  LocalMesh view() const { return {positions, triangles, {}}; }
};

// A grid of columns x rows quads over [0, 1]², each divided into two triangles, at the points that
// `surface` returns.
inline Disc make_grid(std::uint32_t columns, std::uint32_t rows,
                      const std::function<Vec3d(double, double)>& surface) {
  Disc disc;
  for (std::uint32_t j = 0; j <= rows; ++j) {
    for (std::uint32_t i = 0; i <= columns; ++i) {
      disc.positions.push_back(surface(double(i) / columns, double(j) / rows));
    }
  }
  for (std::uint32_t j = 0; j < rows; ++j) {
    for (std::uint32_t i = 0; i < columns; ++i) {
      const std::uint32_t a = j * (columns + 1) + i, b = a + columns + 1;
      disc.triangles.push_back({a, a + 1, b + 1});
      disc.triangles.push_back({a, b + 1, b});
    }
  }
  return disc;
}

// Rings of 6, 12, 18, ... vertices around a pole, at surface(r, angle) with r in [0, 1].
inline Disc make_rings(std::uint32_t rings, const std::function<Vec3d(double, double)>& surface) {
  Disc disc;
  const auto id = [](std::uint32_t ring, std::uint32_t i) {
    return ring == 0 ? 0u : 1 + 3 * ring * (ring - 1) + i % (6 * ring);
  };
  disc.positions.push_back(surface(0, 0));
  for (std::uint32_t r = 1; r <= rings; ++r) {
    for (std::uint32_t i = 0; i < 6 * r; ++i) {
      disc.positions.push_back(surface(double(r) / rings, 2 * std::numbers::pi * i / (6 * r)));
    }
    for (std::uint32_t s = 0; s < 6; ++s) {
      for (std::uint32_t i = 0; i < r; ++i) {
        const std::uint32_t inner = s * (r - 1) + i, outer = s * r + i;
        disc.triangles.push_back({id(r - 1, inner), id(r, outer), id(r, outer + 1)});
        if (i + 1 < r) {
          disc.triangles.push_back({id(r - 1, inner), id(r, outer + 1), id(r - 1, inner + 1)});
        }
      }
    }
  }
  return disc;
}

// The part of the unit sphere within half_angle of the pole.
inline Disc make_cap(double half_angle, std::uint32_t rings) {
  return make_rings(rings, [=](double r, double angle) {
    const double t = r * half_angle;
    return Vec3d{std::sin(t) * std::cos(angle), std::sin(t) * std::sin(angle), std::cos(t)};
  });
}

inline Disc make_cylinder(double arc, double height, std::uint32_t columns, std::uint32_t rows) {
  return make_grid(columns, rows, [=](double u, double v) {
    return Vec3d{std::cos(arc * u), std::sin(arc * u), height * v};
  });
}

// A band of a cone whose half-angle has the sine `slope`, cut along a line.
inline Disc make_cone(double slope, double arc, std::uint32_t columns, std::uint32_t rows) {
  return make_grid(columns, rows, [=](double u, double v) {
    const double l = 0.3 + v;
    return Vec3d{l * slope * std::cos(arc * u), l * slope * std::sin(arc * u),
                 -l * std::sqrt(1 - slope * slope)};
  });
}

// Returns a band of quads along a curve in the plane.
inline Disc make_band(int n, double width, const std::function<Vec2d(double)>& curve) {
  return make_grid(static_cast<std::uint32_t>(n), 1, [&](double t, double side) {
    const Vec2d a = curve(t), b = curve(t + 1e-6);
    const double l = std::hypot(b.x - a.x, b.y - a.y), w = width * side;
    return Vec3d{a.x - w * (b.y - a.y) / l, a.y + w * (b.x - a.x) / l, 0};
  });
}

// The vertices of a flat surface.
inline std::vector<Vec2d> drop_z(const Disc& d) {
  std::vector<Vec2d> uv;
  for (const Vec3d& p : d.positions) uv.push_back({p.x, p.y});
  return uv;
}

inline double mean_edge(const Disc& disc) {
  double sum = 0;
  for (const auto& t : disc.triangles) {
    for (int k = 0; k < 3; ++k) {
      const Vec3d a = disc.positions[t[k]], b = disc.positions[t[(k + 1) % 3]];
      sum += std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
    }
  }
  return sum / (3.0 * disc.triangles.size());
}

// Moves every vertex of a surface around the origin along its radius.
inline void add_radial_noise(Disc& disc, double sigma, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, sigma);
  for (Vec3d& p : disc.positions) {
    const double factor = 1 + normal(random);
    p = {p.x * factor, p.y * factor, p.z * factor};
  }
}

inline void transform(Disc& disc, double scale) {
  for (Vec3d& p : disc.positions) p = {p.x * scale, p.y * scale, p.z * scale};
}

}  // namespace atlas::testing
