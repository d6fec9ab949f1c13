#include "benchmarks/shapes/families.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <utility>
#include <vector>

#include "benchmarks/shapes/figures.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/random.h"

namespace atlas::bench {
namespace {

using test::Shape;

constexpr double kTurn = 2 * std::numbers::pi;

double between(Random& random, double low, double high) {
  return low + (high - low) * random.unit();
}

// Sizes spread evenly over their logarithm.
std::uint64_t size_between(Random& random, double low, double high) {
  return std::uint64_t(std::lround(low * std::pow(high / low, random.unit())));
}

Vec3d point(Random& random) {
  return {between(random, -1, 1), between(random, -1, 1), between(random, -1, 1)};
}

// A trunk with limbs that branch off it.
std::vector<Blob> limbs(Random& random) {
  std::vector<Blob> blobs;
  const Vec3d trunk = point(random);
  blobs.push_back({{0, 0, 0}, trunk, between(random, 0.25, 0.5), between(random, 0.2, 0.5)});
  const std::uint32_t count = 2 + random.below(7);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Blob& from = blobs[random.below(std::uint32_t(blobs.size()))];
    const Vec3d way = point(random);
    const double length = between(random, 0.3, 1.2), radius = between(random, 0.08, 0.25);
    blobs.push_back(
        {from.b,
         {from.b.x + length * way.x, from.b.y + length * way.y, from.b.z + length * way.z},
         radius,
         radius * between(random, 0.5, 1.2)});
  }
  return blobs;
}

Shape smooth(Random& random, std::uint64_t triangles) {
  const double smoothing = between(random, 0.01, 0.08);
  return blend(limbs(random), smoothing, triangles);
}

Shape scan(Random& random, std::uint64_t triangles) {
  const double sigma = between(random, 0.03, 0.18);
  return test::noisy_along_normals(smooth(random, triangles), sigma, random.next());
}

Shape turned_part(Random& random, int around) {
  std::vector<Vec2d> profile{{between(random, 0, 0.3) + 0.05, 0}};
  const double bore = profile[0].x;
  double height = 0;
  for (std::uint32_t steps = 2 + random.below(6); steps > 0; --steps) {
    const double radius = bore + between(random, 0.1, 1);
    profile.push_back({radius, height});
    height += between(random, 0.1, 0.8);
    profile.push_back({random.below(3) == 0 ? bore + between(random, 0.1, 1) : radius, height});
  }
  profile.push_back({bore, height});
  return turned(profile, around);
}

Shape cad(Random& random, std::uint64_t triangles) {
  const int n = std::max(1, int(std::sqrt(double(triangles) / 200)));
  Shape shape = turned_part(random, 6 * n + 6);
  for (std::uint32_t parts = random.below(5); parts > 0; --parts) {
    const Vec3d at = point(random);
    Shape part = random.below(2) == 0
                     ? test::plate_with_holes(1 + int(random.below(9)), 1 + n / 4)
                     : test::box(n, {between(random, 0.2, 2), between(random, 0.2, 2),
                                     between(random, 0.05, 1)});
    shape = test::together(std::move(shape),
                           test::moved(std::move(part), between(random, 0.3, 1.5), at));
  }
  return shape;
}

Shape assembly(Random& random, std::uint64_t triangles) {
  Shape shape;
  while (shape.triangle_count() < triangles) {
    Shape part;
    switch (random.below(5)) {
      case 0:
        part = test::box(1 + int(random.below(3)), {between(random, 0.1, 1), 1, 0.3});
        break;
      case 1:
        part = test::cylinder(8 + int(random.below(16)), 1 + int(random.below(6)), 0.2, 1);
        break;
      case 2:
        part = test::sphere(8 + int(random.below(16)), 6, 0.4);
        break;
      case 3:
        part = test::torus(12 + int(random.below(12)), 8, 0.5, between(random, 0.05, 0.3));
        break;
      default:
        part = turned_part(random, 8 + int(random.below(16)));
    }
    const Vec3d at = point(random);
    shape = test::together(std::move(shape),
                           test::moved(std::move(part), between(random, 0.02, 0.4), at));
  }
  return shape;
}

Shape terrain(Random& random, std::uint64_t triangles) {
  const int n = std::max(3, int(std::lround(std::sqrt(double(triangles) / 2))));
  Shape shape = test::grid(n, n);
  const double step = random.below(3) == 0 ? between(random, 0.02, 0.06) : 0;
  const double rough = between(random, 0.35, 0.6), turn = between(random, 0, kTurn);
  const double high = between(random, 0.05, 0.3);
  for (Vec3f& p : shape.positions) {
    double h = 0, amplitude = high, wave = 4;
    for (int octave = 0; octave < 6; ++octave, amplitude *= rough, wave *= 2.03) {
      const double c = std::cos(turn + octave), s = std::sin(turn + octave);
      h += amplitude * std::sin(wave * (c * p.x - s * p.y) + turn) *
           std::cos(wave * (s * p.x + c * p.y));
    }
    if (step > 0) {
      const double level = std::floor(h / step), rest = h / step - level;
      h = step * (level + rest * rest * rest);
    }
    p.z = float(h);
  }
  return shape;
}

// Maps the points of a flat grid.
template <class Map>
Shape mapped_grid(int nx, int ny, const Map& map) {
  Shape shape = test::grid(nx, ny);
  for (Vec3f& p : shape.positions) {
    const Vec3d q = map(double(p.x), double(p.y));
    p = {float(q.x), float(q.y), float(q.z)};
  }
  return shape;
}

Shape foliage(Random& random, std::uint64_t triangles) {
  Shape shape;
  const int along = 2 + int(random.below(5));
  while (shape.triangle_count() < triangles) {
    const glm::dvec3 at = to_glm(point(random)), tip = glm::normalize(to_glm(point(random)));
    const glm::dvec3 side = glm::normalize(glm::cross(tip, glm::dvec3(0.3, 0.5, 0.8)));
    const glm::dvec3 up = glm::cross(side, tip);
    const double length = between(random, 0.1, 0.3), width = between(random, 0.1, 0.5);
    const double bend = between(random, -0.8, 0.8), fold = between(random, 0, 0.5);
    const auto leaf = mapped_grid(2, along, [&](double u, double v) {
      const double half = width * std::sin(std::numbers::pi * (0.05 + 0.9 * v)) * (u - 0.5);
      return from_glm(
          at + length * (v * tip + half * side + (bend * v * v + fold * std::abs(half)) * up));
    });
    shape = test::together(std::move(shape), leaf);
  }
  return shape;
}

Shape cloth(Random& random, std::uint64_t triangles) {
  const int n = std::max(3, int(std::lround(std::sqrt(double(triangles) / 2))));
  std::array<double, 6> turn, wave, high;
  for (std::size_t i = 0; i < turn.size(); ++i) {
    turn[i] = between(random, 0, kTurn);
    wave[i] = between(random, 4, 30);
    high[i] = between(random, 0.1, 0.9) / wave[i];
  }
  const double drop = between(random, 0, 1.5);
  Shape shape = mapped_grid(n, n, [&](double u, double v) {
    double h = -drop * ((u - 0.5) * (u - 0.5) + (v - 0.5) * (v - 0.5));
    for (std::size_t i = 0; i < turn.size(); ++i)
      h += high[i] * std::sin(wave[i] * (u * std::cos(turn[i]) + v * std::sin(turn[i])) + turn[i]);
    return Vec3d{u, v, h};
  });
  // Holes and torn borders, of whole triangles.
  const std::uint32_t holes = random.below(4);
  for (std::uint32_t i = 0; i < holes; ++i) {
    const double x = random.unit(), y = random.unit(), r = between(random, 0.03, 0.12);
    std::vector<std::uint32_t> kept;
    for (std::size_t t = 0; t < shape.triangle_count(); ++t) {
      const Vec3f p = shape.positions[shape.indices[3 * t]];
      if (std::hypot(p.x - x, p.y - y) < r) continue;
      kept.insert(kept.end(), &shape.indices[3 * t], &shape.indices[3 * t] + 3);
    }
    shape.indices = std::move(kept);
  }
  return shape;
}

// A closed tube around a curve that winds p times around an axis and q times around its core.
Shape tubes(Random& random, std::uint64_t triangles) {
  const double radius = between(random, 0.04, 0.3);
  if (random.below(3) == 0) {
    const double n = std::sqrt(double(triangles) / (2 / radius));
    return test::torus(std::max(8, int(n / radius)), std::max(6, int(n)), 1, radius);
  }
  const std::uint32_t p = 1 + random.below(3), q = 1 + random.below(4);
  const double core = between(random, 0.3, 0.5), thick = radius / (1 + p) / 2;
  const auto curve = [&](double t) {
    const double r = 1 + core * std::cos(q * t);
    return glm::dvec3(r * std::cos(p * t), r * std::sin(p * t), core * std::sin(q * t));
  };
  const double length = kTurn * std::hypot(double(p), double(q) * core);
  const double n = std::sqrt(double(triangles) / 2 * thick * kTurn / length);
  const auto across = std::uint32_t(std::max(5.0, n)),
             around = std::uint32_t(std::max(12.0, n * length / (thick * kTurn)));
  Shape shape;
  for (std::uint32_t i = 0; i < around; ++i) {
    const double t = kTurn * i / around;
    const glm::dvec3 at = curve(t), ahead = glm::normalize(curve(t + 1e-4) - curve(t - 1e-4));
    const glm::dvec3 out =
        glm::normalize(glm::cross(ahead, glm::dvec3(-std::sin(p * t), std::cos(p * t), 0.2)));
    const glm::dvec3 up = glm::cross(ahead, out);
    for (std::uint32_t k = 0; k < across; ++k) {
      const double a = kTurn * k / across;
      shape.positions.push_back(
          from_glm(glm::vec3(at + thick * (std::cos(a) * out + std::sin(a) * up))));
    }
  }
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t k = 0; k < across; ++k) {
      const std::uint32_t j = (i + 1) % around, l = (k + 1) % across;
      shape.add_quad(i * across + k, j * across + k, j * across + l, i * across + l);
    }
  return shape;
}

// A wall whose windows lie back from it, with reveals. Every opening has cells of its own.
Shape facade(Random& random, std::uint64_t triangles) {
  const int windows = std::max(1, int(std::lround(std::sqrt(double(triangles) / 26))));
  const int n = 2 * windows + 1;
  const double deep = between(random, 0.05, 0.4), wide = between(random, 0.3, 0.7);
  Shape shape;
  const auto at = [&](int i) { return i / 2 + (i % 2 == 0 ? 0.0 : 1 - wide); };
  const auto vertex = [&](int i, int j, bool back) {
    shape.positions.push_back({float(at(i)), float(at(j)), back ? float(-deep) : 0.0f});
    return std::uint32_t(shape.positions.size() - 1);
  };
  std::vector<std::uint32_t> front;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) front.push_back(vertex(i, j, false));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const std::uint32_t a = front[std::size_t(j * (n + 1) + i)], b = a + 1,
                          c = b + std::uint32_t(n + 1), d = c - 1;
      if (i % 2 == 0 || j % 2 == 0) {
        shape.add_quad(a, b, c, d);
        continue;
      }
      const std::array outer{a, b, c, d};
      const std::array inner{vertex(i, j, true), vertex(i + 1, j, true), vertex(i + 1, j + 1, true),
                             vertex(i, j + 1, true)};
      for (std::size_t k = 0; k < 4; ++k)
        shape.add_quad(outer[k], outer[(k + 1) % 4], inner[(k + 1) % 4], inner[k]);
      shape.add_quad(inner[0], inner[1], inner[2], inner[3]);
    }
  return shape;
}

// The faces of blocks whose middle lies within blended capsules.
Shape stairs(Random& random, std::uint64_t triangles) {
  const std::vector<Blob> blobs = limbs(random);
  const int n = std::max(6, int(std::lround(std::sqrt(double(triangles) / 4))));
  const auto inside = [&](int x, int y, int z) {
    const glm::dvec3 q = (glm::dvec3(x, y, z) + 0.5) * (5.0 / n) - 2.5;
    return std::any_of(blobs.begin(), blobs.end(), [&](const Blob& blob) {
      const glm::dvec3 a = to_glm(blob.a), d = to_glm(blob.b) - a;
      const double t = std::clamp(glm::dot(q - a, d) / std::max(glm::dot(d, d), 1e-9), 0.0, 1.0);
      return glm::length(q - a - t * d) < blob.radius_a + t * (blob.radius_b - blob.radius_a);
    });
  };
  Shape shape;
  std::vector<std::uint32_t> corner(std::size_t(n + 1) * (n + 1) * (n + 1), UINT32_MAX);
  const auto vertex = [&](glm::ivec3 p) {
    std::uint32_t& v = corner[(std::size_t(p.z) * (n + 1) + p.y) * (n + 1) + p.x];
    if (v == UINT32_MAX) {
      v = std::uint32_t(shape.positions.size());
      shape.positions.push_back({float(p.x), float(p.y), float(p.z)});
    }
    return v;
  };
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        if (!inside(x, y, z)) continue;
        for (int axis = 0; axis < 3; ++axis)
          for (const int way : {0, 1}) {
            glm::ivec3 next(x, y, z), a(x, y, z);
            next[axis] += way == 1 ? 1 : -1;
            if (inside(next.x, next.y, next.z)) continue;
            a[axis] += way;
            glm::ivec3 u(0), v(0);
            u[(axis + 1) % 3] = v[(axis + 2) % 3] = 1;
            if (way == 0) std::swap(u, v);
            shape.add_quad(vertex(a), vertex(a + u), vertex(a + u + v), vertex(a + v));
          }
      }
  return shape;
}

Shape low(Random& random, std::uint64_t triangles);

struct Family {
  std::string_view name;
  Shape (*make)(Random& random, std::uint64_t triangles);
  double least, most;  // triangles
};
constexpr std::array kFamilies{Family{"smooth", smooth, 1500, 15000},
                               Family{"scan", scan, 1500, 15000},
                               Family{"cad", cad, 500, 12000},
                               Family{"assembly", assembly, 500, 12000},
                               Family{"terrain", terrain, 500, 15000},
                               Family{"foliage", foliage, 500, 8000},
                               Family{"cloth", cloth, 500, 15000},
                               Family{"tubes", tubes, 500, 12000},
                               Family{"facade", facade, 100, 4000},
                               Family{"stairs", stairs, 500, 8000},
                               Family{"low", low, 60, 600}};

Shape low(Random& random, std::uint64_t triangles) {
  return kFamilies[random.below(std::uint32_t(kFamilies.size() - 1))].make(random, triangles);
}

}  // namespace

std::span<const std::string_view> families() {
  static const auto names = [] {
    std::array<std::string_view, kFamilies.size()> result;
    std::transform(kFamilies.begin(), kFamilies.end(), result.begin(),
                   [](const Family& f) { return f.name; });
    return result;
  }();
  return names;
}

Result<Shape> make_member(std::string_view family, std::uint32_t number) {
  for (const Family& f : kFamilies) {
    if (f.name != family) continue;
    Random random(1000003 * std::uint64_t(&f - kFamilies.data()) + number);
    Shape shape = f.make(random, size_between(random, f.least, f.most));
    shape.name = fmt::format("{}-{}", family, number);
    return shape;
  }
  return Status{ErrorCode::bad_option, fmt::format("{}: no such family of meshes", family)};
}

}  // namespace atlas::bench
