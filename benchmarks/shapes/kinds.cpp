#include "benchmarks/shapes/kinds.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "benchmarks/shapes/rings.h"

namespace atlas::bench {
namespace {

using test::Shape;

constexpr double kRoughNoise = 0.2;  // standard deviation in mean edge lengths

int side(double value) {
  return std::max(3, int(std::lround(value)));
}

// The triangles are even. At the poles of a latitude-longitude ball, noise would be larger than
// edges.
Shape ball(std::uint64_t triangles) {
  const double n = std::sqrt(double(triangles) / 20);
  return test::geodesic_sphere(std::max(1, int(std::lround(n))), 0.5);
}

// Adds noise as good scanners leave it: evenly distributed in each coordinate, to 13 % of the mean
// edge length, which is a standard deviation of 7.6 %.
Shape scan(std::uint64_t triangles) {
  Shape shape = ball(triangles);
  for (Vec3f& p : shape.positions) {
    const double bump = 1 + 0.12 * std::sin(9 * p.x) * std::cos(7 * p.y) * std::sin(8 * p.z + 1);
    p = {float(p.x * bump), float(p.y * bump), float(p.z * bump)};
  }
  return test::noisy(std::move(shape), 0.2 * std::sqrt(std::numbers::pi / double(triangles)), 7);
}

// A ball of a cube's grid, whose edges vary in length as those of scanners' grids do, with noise at
// which single vertices exceed the stretch bound.
Shape rough(std::uint64_t triangles) {
  Shape shape = test::box(std::max(1, int(std::lround(std::sqrt(double(triangles) / 12)))));
  for (Vec3f& p : shape.positions) {
    const Vec3d q{p.x - 0.5, p.y - 0.5, p.z - 0.5};
    const double stretch = 0.5 / std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z);
    p = {float(q.x * stretch), float(q.y * stretch), float(q.z * stretch)};
  }
  return test::noisy_along_normals(std::move(shape), kRoughNoise);
}

double height(double x, double y) {
  double h = 0, amplitude = 60, wave = 1.0 / 350;
  for (int octave = 0; octave < 8; ++octave, amplitude *= 0.48, wave *= 2.03) {
    const double turn = 1.3 * octave, c = std::cos(turn), s = std::sin(turn);
    h += amplitude * std::sin(wave * (c * x - s * y) + octave) * std::cos(wave * (s * x + c * y));
  }
  return h;
}

Shape terrain(std::uint64_t triangles) {
  const int n = side(std::sqrt(double(triangles) / 2));
  Shape shape = test::grid(n, n, 2000, 2000);
  for (Vec3f& p : shape.positions) p.z = float(height(p.x, p.y));
  return shape;
}

void append(Shape& all, const Shape& part, double turn, Vec3d offset) {
  const double c = std::cos(turn), s = std::sin(turn);
  const auto first = std::uint32_t(all.positions.size());
  for (const Vec3f& p : part.positions)
    all.positions.push_back({float(c * p.x - s * p.y + offset.x),
                             float(s * p.x + c * p.y + offset.y), float(p.z + offset.z)});
  for (const std::uint32_t i : part.indices) all.indices.push_back(first + i);
}

// Parts of millimetres to decimetres on a floor of 10 m, as CAD systems export them.
Shape assembly(std::uint64_t triangles) {
  std::mt19937_64 random(11);
  const auto uniform = [&](double a, double b) {
    return a + (b - a) * double(random() >> 11) * 0x1p-53;
  };
  Shape all;
  while (all.triangle_count() < triangles) {
    const double size = std::exp(uniform(std::log(0.002), std::log(0.2)));
    Shape part;
    switch (random() % 3) {
      case 0:
        part = test::box(2, {size, size * uniform(0.1, 1), size * uniform(0.02, 1)});
        break;
      case 1:
        part = test::cylinder(24, 1, 0.2 * size, size);
        break;
      default:
        part = test::plate_with_holes(1, 1);
        part = test::moved(part, size / 3);
        break;
    }
    const Vec3d at{uniform(0, 10), uniform(0, 10), uniform(0, 2)};
    append(all, part, uniform(0, 6.28), at);
  }
  return all;
}

// Rotates a vertex by a unit quaternion, then moves it.
Vec3f placed(const Vec3f& p, const std::array<double, 4>& q, Vec3d offset) {
  const double x = q[1] * p.z - q[2] * p.y + q[3] * p.x, y = q[2] * p.x - q[0] * p.z + q[3] * p.y,
               z = q[0] * p.y - q[1] * p.x + q[3] * p.z;
  return {float(p.x + 2 * (q[1] * z - q[2] * y) + offset.x),
          float(p.y + 2 * (q[2] * x - q[0] * z) + offset.y),
          float(p.z + 2 * (q[0] * y - q[1] * x) + offset.z)};
}

// Fastening parts of assemblies: a dozen standard parts (screws, washers, brackets) repeated with
// random rotations in a space of one metre.
Shape fasteners(std::uint64_t triangles) {
  std::mt19937_64 random(12);
  const auto uniform = [&](double a, double b) {
    return a + (b - a) * double(random() >> 11) * 0x1p-53;
  };
  std::vector<Shape> kinds;
  for (int k = 0; k < 12; ++k) {
    const double size = 0.01 * (1 + k);
    kinds.push_back(k % 3 == 0   ? test::cylinder(24, 4, 0.15 * size, size)
                    : k % 3 == 1 ? test::moved(test::plate_with_holes(1, 2), size / 3)
                                 : test::box(4, {size, 0.7 * size, 0.2 * size}));
  }
  Shape all;
  while (all.triangle_count() < triangles) {
    const Shape& part = kinds[random() % kinds.size()];
    std::array<double, 4> q;
    double norm = 0;
    for (double& c : q) {
      c = uniform(-1, 1);
      norm += c * c;
    }
    for (double& c : q) c /= std::sqrt(norm);
    const Vec3d offset{uniform(0, 1), uniform(0, 1), uniform(0, 1)};
    const auto first = std::uint32_t(all.positions.size());
    for (const Vec3f& p : part.positions) all.positions.push_back(placed(p, q, offset));
    for (const std::uint32_t i : part.indices) all.indices.push_back(first + i);
  }
  return all;
}

// Finds the cells per hole by making the smallest such plate.
Shape genus(std::uint64_t triangles) {
  const auto least = double(test::plate_with_holes(50, 1).triangle_count());
  return test::plate_with_holes(
      50, std::max(1, int(std::lround(std::sqrt(double(triangles) / least)))));
}

}  // namespace

Result<Shape> make_shape(const std::string& kind, std::uint64_t triangles) {
  Shape shape;
  if (kind == "sphere")
    shape = ball(triangles);
  else if (kind == "scan")
    shape = scan(triangles);
  else if (kind == "rough")
    shape = rough(triangles);
  else if (kind == "torus") {
    const double n = std::sqrt(double(triangles) / 5);
    shape = test::torus(side(2.5 * n), side(n));
  } else if (kind == "terrain")
    shape = terrain(triangles);
  else if (kind == "assembly")
    shape = assembly(triangles);
  else if (kind == "fasteners")
    shape = fasteners(triangles);
  else if (kind == "genus")
    shape = genus(triangles);
  else if (kind == "gasket")
    shape = gasket(triangles);
  else if (kind == "seat")
    shape = seat(triangles);
  else if (kind == "mail")
    shape = mail(triangles);
  else if (kind == "soup")
    shape = test::soup(int(triangles), 5);
  else if (kind == "needles")
    shape = test::needles(int(triangles), 1000);
  else
    return Status{ErrorCode::bad_option,
                  fmt::format("{}: no such work (there are {})", kind, kShapeKinds)};
  shape.name = fmt::format("{}:{}", kind, triangles);
  return shape;
}

}  // namespace atlas::bench
