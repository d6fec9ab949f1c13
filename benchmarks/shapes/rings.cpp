#include "benchmarks/shapes/rings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace atlas::bench {
namespace {

using test::Shape;

constexpr double kTurn = 2 * std::numbers::pi;

// Point (u, v) of the unit square, bent to a ring of radii `inner` to 1.
Vec3f on_ring(double u, double v, double inner, double height) {
  const double angle = kTurn * std::fmod(u, 1), radius = inner + (1 - inner) * v;
  return {float(radius * std::cos(angle)), float(radius * std::sin(angle)), float(height)};
}

// Point k of n on the border of a cell, or on the hole within it.
Vec2d on_cell(int k, int n) {
  const double t = 4.0 * k / n;
  const int side = int(t);
  const double along = t - side;
  const std::array<Vec2d, 5> corners{{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}}};
  const Vec2d a = corners[std::size_t(side)], b = corners[std::size_t(side) + 1];
  return {a.x + along * (b.x - a.x), a.y + along * (b.y - a.y)};
}

Vec2d on_hole(int k, int n, double radius) {
  const double angle = kTurn * (double(k) / n + 0.625);
  return {0.5 + radius * std::cos(angle), 0.5 + radius * std::sin(angle)};
}

// A thin block between two arcs.
void add_arc(Shape& shape, double radius, double turn, double span, int n) {
  constexpr double kWidth = 0.12, kHeight = 0.05;
  const auto first = std::uint32_t(shape.positions.size());
  for (int i = 0; i <= n; ++i) {
    const double angle = turn + span * i / n, c = std::cos(angle), s = std::sin(angle);
    for (const double z : {0.0, kHeight})
      for (const double r : {radius, radius + kWidth})
        shape.positions.push_back({float(r * c), float(r * s), float(z)});
  }
  constexpr std::array<std::uint32_t, 5> kAround{0, 1, 3, 2, 0};
  for (std::uint32_t i = 0; i < std::uint32_t(n); ++i)
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t a = first + 4 * i + kAround[k], b = first + 4 * i + kAround[k + 1];
      shape.add_quad(b, a, a + 4, b + 4);
    }
  const std::uint32_t last = first + 4 * std::uint32_t(n);
  shape.add_quad(first, first + 1, first + 3, first + 2);
  shape.add_quad(last, last + 2, last + 3, last + 1);
}

}  // namespace

Shape gasket(std::uint64_t triangles) {
  constexpr int kAround = 80, kRows = 2;
  constexpr double kInner = 0.85, kHeight = 0.01, kHole = 0.28;
  const int n = 4 * std::max(1, int(std::lround(double(triangles) / (24.0 * kAround * kRows))));
  Shape shape;
  for (int row = 0; row < kRows; ++row)
    for (int cell = 0; cell < kAround; ++cell) {
      const auto first = std::uint32_t(shape.positions.size());
      for (int k = 0; k < n; ++k)
        for (const double z : {0.0, kHeight})
          for (const Vec2d p : {on_cell(k, n), on_hole(k, n, kHole)})
            shape.positions.push_back(
                on_ring((cell + p.x) / kAround, (row + p.y) / kRows, kInner, z));
      for (std::uint32_t k = 0; k < std::uint32_t(n); ++k) {
        const std::uint32_t a = first + 4 * k, b = first + 4 * ((k + 1) % std::uint32_t(n));
        shape.add_quad(a, b, b + 1, a + 1);          // below
        shape.add_quad(a + 2, a + 3, b + 3, b + 2);  // above
        shape.add_quad(a + 1, b + 1, b + 3, a + 3);  // wall of the hole
        const bool rim = row == 0 ? k < std::uint32_t(n) / 4
                                  : k >= std::uint32_t(n) / 2 && k < 3 * std::uint32_t(n) / 4;
        if (rim) shape.add_quad(b, a, a + 2, b + 2);
      }
    }
  return shape;
}

Shape seat(std::uint64_t triangles) {
  constexpr int kArcs = 30;
  const int n = std::max(4, int(std::lround(double(triangles) / (8.0 * kArcs))));
  Shape shape;
  for (int i = 0; i < kArcs; ++i)
    add_arc(shape, 0.5 + 0.02 * i, 2.4 * i, kTurn * (0.25 + 0.002 * i), n);
  return shape;
}

Shape mail(std::uint64_t triangles) {
  constexpr int kSide = 30;
  const double n = std::sqrt(double(triangles) / (4.0 * kSide * kSide));
  const Shape ring =
      test::torus(std::max(8, int(std::lround(2 * n))), std::max(4, int(std::lround(n))), 1, 0.15);
  Shape shape;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      shape = test::together(std::move(shape), test::moved(ring, 1, {1.4 * x, 1.4 * y, 0.0}));
  return shape;
}

}  // namespace atlas::bench
