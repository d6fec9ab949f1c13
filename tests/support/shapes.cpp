#include "tests/support/shapes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <random>

#include "libatlas/core/glm_bridge.h"

namespace atlas::test {
namespace {

constexpr double kPi = std::numbers::pi;

// Returns a lattice of (columns + 1) x (rows + 1) vertices. If `wrap`, it is closed in the first
// direction, which then has `columns` vertices.
template <class Place>
Shape lattice(int columns, int rows, bool wrap, const Place& place) {
  Shape shape;
  const int width = wrap ? columns : columns + 1;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i < width; ++i) shape.positions.push_back(from_glm(glm::vec3(place(i, j))));
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const std::uint32_t i1 = std::uint32_t(i + 1) % width;
      const std::uint32_t low = std::uint32_t(j) * width, high = low + width;
      shape.add_quad(low + i, low + i1, high + i1, high + i);
    }
  return shape;
}

// Finds vertices by position, so that faces that are made separately share them.
class Welder {
 public:
  explicit Welder(Shape& shape) : shape_(shape) {}
  std::uint32_t operator()(glm::dvec3 p) {
    const std::array<float, 3> key{float(p.x), float(p.y), float(p.z)};
    const auto [it, fresh] = index_.emplace(key, std::uint32_t(shape_.positions.size()));
    if (fresh) shape_.positions.push_back({key[0], key[1], key[2]});
    return it->second;
  }

 private:
  Shape& shape_;
  std::map<std::array<float, 3>, std::uint32_t> index_;
};

// Adds an n x n grid over the parallelogram at `corner`, facing in the direction du x dv.
void add_face(Shape& shape, Welder& weld, const std::array<glm::dvec3, 3>& face, int n) {
  const glm::dvec3 corner = face[0], du = face[1], dv = face[2];
  const auto at = [&](int i, int j) {
    return weld(corner + du * (double(i) / n) + dv * (double(j) / n));
  };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      shape.add_quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
}

double uniform(std::mt19937_64& random) {
  return double(random() >> 11) * 0x1p-53;
}

// In the unit cube. Drawn one after the other, since compilers evaluate arguments in any order.
glm::dvec3 random_point(std::mt19937_64& random) {
  const double z = uniform(random), y = uniform(random), x = uniform(random);
  return {x, y, z};
}

}  // namespace

void Shape::add_quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  for (std::uint32_t v : {a, b, c, a, c, d}) indices.push_back(v);
}

Shape grid(int nx, int ny, double width, double height) {
  Shape shape = lattice(
      nx, ny, false, [&](int i, int j) { return glm::dvec3(width * i / nx, height * j / ny, 0); });
  shape.name = "grid";
  return shape;
}

Shape box(int n, Vec3d size) {
  Shape shape;
  shape.name = "box";
  Welder weld(shape);
  const glm::dvec3 o(0), x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
  for (const auto& face : std::initializer_list<std::array<glm::dvec3, 3>>{
           {o, y, x}, {z, x, y}, {o, x, z}, {y, z, x}, {o, z, y}, {x, y, z}})
    add_face(shape, weld, face, n);
  return shape;
}

Shape sphere(int around, int rings, double radius) {
  Shape shape;
  shape.name = "sphere";
  shape.positions.push_back({0, 0, float(-radius)});
  for (int j = 1; j < rings; ++j)
    for (int i = 0; i < around; ++i) {
      const double a = 2 * kPi * i / around, b = -kPi / 2 + kPi * j / rings;
      shape.positions.push_back({float(radius * std::cos(b) * std::cos(a)),
                                 float(radius * std::cos(b) * std::sin(a)),
                                 float(radius * std::sin(b))});
    }
  shape.positions.push_back({0, 0, float(radius)});
  const auto at = [&](int ring, int i) {
    return std::uint32_t(1 + (ring - 1) * around + i % around);
  };
  const auto top = std::uint32_t(shape.positions.size() - 1);
  for (int i = 0; i < around; ++i) {
    for (std::uint32_t v : {std::uint32_t(0), at(1, i + 1), at(1, i)}) shape.indices.push_back(v);
    for (int j = 1; j + 1 < rings; ++j)
      shape.add_quad(at(j, i), at(j, i + 1), at(j + 1, i + 1), at(j + 1, i));
    for (std::uint32_t v : {at(rings - 1, i), at(rings - 1, i + 1), top})
      shape.indices.push_back(v);
  }
  return shape;
}

Shape icosphere(int subdivisions, double radius) {
  Shape shape;
  shape.name = "icosphere";
  const double g = (1 + std::sqrt(5.0)) / 2;
  std::vector<glm::dvec3> p{{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                            {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                            {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  shape.indices = {0, 11, 5,  0, 5,  1, 0, 1, 7, 0, 7,  10, 0, 10, 11, 1, 5, 9, 5, 11,
                   4, 11, 10, 2, 10, 7, 6, 7, 1, 8, 3,  9,  4, 3,  4,  2, 3, 2, 6, 3,
                   6, 8,  3,  8, 9,  4, 9, 5, 2, 4, 11, 6,  2, 10, 8,  6, 7, 9, 8, 1};
  for (int level = 0; level < subdivisions; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middle;
    const auto half = [&](std::uint32_t a, std::uint32_t b) {
      const auto [it, fresh] = middle.emplace(std::minmax(a, b), std::uint32_t(p.size()));
      if (fresh) p.push_back(p[a] + p[b]);
      p[it->second] = glm::normalize(p[a]) + glm::normalize(p[b]);
      return it->second;
    };
    std::vector<std::uint32_t> fine;
    for (std::size_t t = 0; t < shape.indices.size(); t += 3) {
      const std::uint32_t a = shape.indices[t], b = shape.indices[t + 1], c = shape.indices[t + 2];
      const std::uint32_t ab = half(a, b), bc = half(b, c), ca = half(c, a);
      for (std::uint32_t v : {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca}) fine.push_back(v);
    }
    shape.indices = fine;
  }
  for (const glm::dvec3& q : p)
    shape.positions.push_back(from_glm(glm::vec3(radius * glm::normalize(q))));
  return shape;
}

Shape torus(int around, int across, double major, double minor) {
  Shape shape;
  shape.name = "torus";
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double a = 2 * kPi * i / around, b = 2 * kPi * j / across,
                   r = major + minor * std::cos(b);
      shape.positions.push_back(
          {float(r * std::cos(a)), float(r * std::sin(a)), float(minor * std::sin(b))});
    }
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const auto at = [&](int u, int v) {
        return std::uint32_t((u % around) * across + v % across);
      };
      shape.add_quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
  return shape;
}

Shape cylinder(int around, int along, double radius, double height) {
  Shape shape = lattice(around, along, true, [&](int i, int j) {
    const double a = 2 * kPi * i / around;
    return glm::dvec3(radius * std::cos(a), radius * std::sin(a), height * j / along);
  });
  shape.name = "cylinder";
  return shape;
}

Shape cone(int around, int along, double half_angle, double slant) {
  Shape shape;
  shape.name = "cone";
  shape.positions.push_back({});
  const auto at = [&](int ring, int i) { return std::uint32_t(1 + (ring - 1) * (around + 1) + i); };
  for (int j = 1; j <= along; ++j)
    for (int i = 0; i <= around; ++i) {
      // A billionth of a turn is left open. Otherwise rounding would decide whether the sides meet.
      const double a = 2 * kPi * (1 - 1e-9) * i / around, s = slant * j / along,
                   r = s * std::sin(half_angle);
      shape.positions.push_back(
          {float(r * std::cos(a)), float(r * std::sin(a)), float(-s * std::cos(half_angle))});
    }
  for (int i = 0; i < around; ++i) {
    for (std::uint32_t v : {std::uint32_t(0), at(1, i), at(1, i + 1)}) shape.indices.push_back(v);
    for (int j = 1; j < along; ++j)
      shape.add_quad(at(j, i), at(j + 1, i), at(j + 1, i + 1), at(j, i + 1));
  }
  return shape;
}

Shape closed_cone(int around, double height) {
  Shape shape;
  shape.name = "closed cone";
  for (int i = 0; i < around; ++i) {
    const double a = 2 * kPi * i / around;
    shape.positions.push_back({float(std::cos(a)), float(std::sin(a)), 0});
  }
  shape.positions.push_back({0, 0, float(height)});
  shape.positions.push_back({0, 0, 0});
  const auto rim = std::uint32_t(around);
  for (std::uint32_t i = 0; i < rim; ++i) {
    const std::uint32_t k = (i + 1) % rim;
    shape.indices.insert(shape.indices.end(), {i, k, rim, k, i, rim + 1});
  }
  return shape;
}

Shape cap(int around, int rings, double theta) {
  Shape shape;
  shape.name = "cap";
  shape.positions.push_back({0, 0, 1});
  const auto at = [&](int ring, int i) {
    return std::uint32_t(1 + (ring - 1) * around + i % around);
  };
  for (int j = 1; j <= rings; ++j)
    for (int i = 0; i < around; ++i) {
      const double a = 2 * kPi * i / around, b = theta * j / rings;
      shape.positions.push_back(
          {float(std::sin(b) * std::cos(a)), float(std::sin(b) * std::sin(a)), float(std::cos(b))});
    }
  for (int i = 0; i < around; ++i) {
    for (std::uint32_t v : {std::uint32_t(0), at(1, i), at(1, i + 1)}) shape.indices.push_back(v);
    for (int j = 1; j < rings; ++j)
      shape.add_quad(at(j, i), at(j + 1, i), at(j + 1, i + 1), at(j, i + 1));
  }
  return shape;
}

Shape plate_with_holes(int holes, int n) {
  Shape shape;
  shape.name = "plate_" + std::to_string(holes);
  Welder weld(shape);
  const int columns = 2 * holes + 1;
  const auto solid = [&](int x, int y, int z) {
    return x >= 0 && x < columns && y >= 0 && y < 3 && z == 0 && !(x % 2 == 1 && y == 1);
  };
  const glm::dvec3 ex(1, 0, 0), ey(0, 1, 0), ez(0, 0, 1);
  for (int x = 0; x < columns; ++x)
    for (int y = 0; y < 3; ++y) {
      if (!solid(x, y, 0)) continue;
      const glm::dvec3 o(x, y, 0);
      add_face(shape, weld, {o, ey, ex}, n);
      add_face(shape, weld, {o + ez, ex, ey}, n);
      if (!solid(x, y - 1, 0)) add_face(shape, weld, {o, ex, ez}, n);
      if (!solid(x, y + 1, 0)) add_face(shape, weld, {o + ey, ez, ex}, n);
      if (!solid(x - 1, y, 0)) add_face(shape, weld, {o, ez, ey}, n);
      if (!solid(x + 1, y, 0)) add_face(shape, weld, {o + ex, ey, ez}, n);
    }
  return shape;
}

Shape soup(int n, std::uint64_t seed) {
  Shape shape;
  shape.name = "soup";
  std::mt19937_64 random(seed);
  for (int i = 0; i < n; ++i) {
    const glm::dvec3 centre = random_point(random);
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 offset = random_point(random) - 0.5;
      shape.positions.push_back(from_glm(glm::vec3(centre + 0.2 * offset)));
      shape.indices.push_back(std::uint32_t(3 * i + k));
    }
  }
  return shape;
}

Shape fan(int n) {
  Shape shape;
  shape.name = "fan";
  shape.positions.push_back({});
  for (int i = 0; i < n; ++i)
    shape.positions.push_back(
        {float(std::cos(2 * kPi * i / n)), float(std::sin(2 * kPi * i / n)), 0});
  for (int i = 0; i < n; ++i)
    for (std::uint32_t v : {0u, std::uint32_t(1 + i), std::uint32_t(1 + (i + 1) % n)})
      shape.indices.push_back(v);
  return shape;
}

Shape needles(int n, double aspect) {
  Shape shape;
  shape.name = "needles";
  for (int i = 0; i < n + 2; ++i)
    shape.positions.push_back({float(i / 2 / aspect), float(i % 2), 0});
  for (int i = 0; i < n; ++i) {
    const std::uint32_t a = std::uint32_t(i), odd = i % 2;
    for (std::uint32_t v : {a, a + 2 - odd, a + 1 + odd}) shape.indices.push_back(v);
  }
  return shape;
}

Shape sheets(int n) {
  Shape shape;
  shape.name = "sheets";
  shape.positions = {{0, 0, 0}, {0, 0, 1}};
  for (int i = 0; i < n; ++i) {
    shape.positions.push_back({float(std::cos(0.9 * i)), float(std::sin(0.9 * i)), 0.5f});
    for (const std::uint32_t v : {0u, 1u, std::uint32_t(2 + i)}) shape.indices.push_back(v);
  }
  return shape;
}

Shape noisy(Shape shape, double amplitude, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  for (Vec3f& p : shape.positions)
    for (float* x : {&p.x, &p.y, &p.z}) *x = float(*x + amplitude * (2 * uniform(random) - 1));
  shape.name += "_noisy";
  return shape;
}

Shape moved(Shape shape, double scale, Vec3d offset) {
  for (Vec3f& p : shape.positions)
    p = {float(scale * p.x + offset.x), float(scale * p.y + offset.y),
         float(scale * p.z + offset.z)};
  return shape;
}

Shape together(Shape a, const Shape& b) {
  const auto first = std::uint32_t(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (std::uint32_t v : b.indices) a.indices.push_back(first + v);
  a.name += "+" + b.name;
  return a;
}

double surface_area(const Shape& shape) {
  double area = 0;
  for (std::size_t t = 0; t < shape.indices.size(); t += 3) {
    const glm::dvec3 a = to_dvec(shape.positions[shape.indices[t]]);
    area += 0.5 * glm::length(glm::cross(to_dvec(shape.positions[shape.indices[t + 1]]) - a,
                                         to_dvec(shape.positions[shape.indices[t + 2]]) - a));
  }
  return area;
}

namespace {

std::map<std::pair<std::uint32_t, std::uint32_t>, int> edge_uses(const Shape& shape) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (std::size_t i = 0; i < shape.indices.size(); ++i)
    ++uses[std::minmax(shape.indices[i], shape.indices[i % 3 == 2 ? i - 2 : i + 1])];
  return uses;
}

}  // namespace

long euler_characteristic(const Shape& shape) {
  return long(shape.positions.size()) - long(edge_uses(shape).size()) +
         long(shape.triangle_count());
}

std::size_t border_edges(const Shape& shape) {
  std::size_t count = 0;
  for (const auto& [edge, uses] : edge_uses(shape)) count += uses == 1;
  return count;
}

std::vector<Shape> zoo() {
  return {grid(12, 9, 3, 2),
          box(6),
          sphere(24, 14),
          icosphere(3),
          torus(36, 18),
          cylinder(32, 6),
          cone(32, 8, 0.5),
          cap(24, 8, 0.9),
          plate_with_holes(3, 3),
          noisy(icosphere(3), 0.02, 7),
          soup(60, 3),
          fan(64),
          needles(40, 1e4),
          together(box(4), moved(torus(20, 10), 0.5, {4, 0, 0}))};
}

}  // namespace atlas::test
