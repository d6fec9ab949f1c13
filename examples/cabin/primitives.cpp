#include "examples/cabin/primitives.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace cabin {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kStep = 1e-5;  // step of finite differences, in parameter or metre

// Returns the normal after a warp, from the images of two tangents.
glm::dvec3 warped_normal(const Warp& warp, glm::dvec3 p, glm::dvec3 n) {
  const glm::dvec3 helper = std::abs(n.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 t1 = glm::normalize(glm::cross(helper, n)), t2 = glm::cross(n, t1);
  const glm::dvec3 d1 = warp(p + kStep * t1) - warp(p - kStep * t1);
  const glm::dvec3 d2 = warp(p + kStep * t2) - warp(p - kStep * t2);
  return glm::normalize(glm::cross(d1, d2));
}

glm::dvec3 surface_normal(const Surface& s, double u, double v) {
  const glm::dvec3 du = s(u + kStep, v) - s(u - kStep, v), dv = s(u, v + kStep) - s(u, v - kStep);
  const glm::dvec3 n = glm::cross(du, dv);
  return glm::length(n) > 0 ? glm::normalize(n) : glm::dvec3(0, 0, 1);
}

// One coordinate of a rounded box's face: the coordinate of the inner box, and the tangent of the
// angle by which the normal leans along it.
struct Station {
  double inner, lean, arc;
};

std::vector<Station> stations(const Builder& builder, const RoundedBox& box, int axis) {
  const double radius = box.radius, flat = box.half[axis] - radius;
  const int corner = std::max(box.corner_least, std::min(4, builder.segments(radius * kPi / 2)));
  const int middle = builder.segments(2 * flat, box.least[axis]);
  const int few = std::min(box.least[axis], 1);
  std::vector<Station> result;
  if (builder.coarse()) {
    // The coarsest box still has its round normals: it has few stations, none of them where the
    // rounding starts.
    result.push_back({-flat, -1, -flat - radius * kPi / 4});
    if (few > 0) result.push_back({0, 0, 0});
    result.push_back({flat, 1, flat + radius * kPi / 4});
    return result;
  }
  for (int i = 0; i < corner; ++i) {
    const double angle = -kPi / 4 * (corner - i) / corner;
    result.push_back({-flat, std::tan(angle), -flat + radius * angle});
  }
  for (int i = 0; i <= middle; ++i) {
    const double x = flat * (2.0 * i / middle - 1);
    result.push_back({x, 0, x});
  }
  for (int i = 1; i <= corner; ++i) {
    const double angle = kPi / 4 * i / corner;
    result.push_back({flat, std::tan(angle), flat + radius * angle});
  }
  return result;
}

// A point of a ring's path, and the outward direction there.
struct PathPoint {
  glm::dvec2 place, outwards;
  double arc = 0;  // length of the path so far
};

// Returns a closed rounded rectangle, anticlockwise. Corners are divided evenly, straight sides by
// the edge length.
std::vector<PathPoint> ring_path(const Builder& builder, const Ring& ring) {
  const double radius = ring.path_radius;
  const glm::dvec2 flat = ring.path_half - radius;
  const int corner = builder.segments(radius * kPi / 2, builder.coarse() ? 2 : 6);
  std::vector<PathPoint> path;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const glm::dvec2 sign(quarter == 0 || quarter == 3 ? 1 : -1, quarter < 2 ? 1 : -1);
    for (int i = 0; i <= corner; ++i) {
      const double angle = kPi / 2 * (quarter + double(i) / corner);
      const glm::dvec2 out(std::cos(angle), std::sin(angle));
      path.push_back({sign * flat + radius * out, out});
    }
    // The straight side to the next corner, without its ends.
    const double length = 2 * (quarter % 2 == 0 ? flat.x : flat.y);
    const int cuts = builder.segments(length, builder.coarse()   ? 1
                                              : quarter % 2 == 0 ? 3
                                                                 : ring.least);
    const PathPoint from = path.back();
    const glm::dvec2 along(-from.outwards.y, from.outwards.x);
    for (int i = 1; i < cuts; ++i)
      path.push_back({from.place + along * (length * i / cuts), from.outwards});
  }
  path.push_back(path.front());
  for (std::size_t i = 1; i < path.size(); ++i)
    path[i].arc = path[i - 1].arc + glm::distance(path[i].place, path[i - 1].place);
  return path;
}

double power(double x, double exponent) {
  return std::copysign(std::pow(std::abs(x), exponent), x);
}

}  // namespace

void add_grid(Builder& builder, const GridShape& shape) {
  std::vector<Corner> row(shape.nu + 1), previous;
  for (int j = 0; j <= shape.nv; ++j) {
    for (int i = 0; i <= shape.nu; ++i) {
      const double u = double(i) / shape.nu, v = double(j) / shape.nv;
      const glm::dvec3 n = surface_normal(shape.surface, u, v);
      const glm::dvec3 p = shape.surface(u, v);
      row[i] = {p, shape.flip ? -n : n,
                shape.tiles_of ? shape.tiles_of(p) : glm::dvec2(u, v) * shape.tiles};
    }
    for (int i = 0; j > 0 && i < shape.nu; ++i)
      builder.quad(previous[i], previous[i + 1], row[i + 1], row[i]);
    previous = row;
  }
}

void add_rounded_box(Builder& builder, const RoundedBox& box) {
  const double radius = box.radius;
  for (int axis = 0; axis < 3; ++axis) {
    // Where possible, v points upwards, so that wood grain does, too.
    const int a = axis == 1 ? 0 : (axis + 1) % 3, b = axis == 1 ? 2 : (axis + 2) % 3;
    const auto along_a = stations(builder, box, a), along_b = stations(builder, box, b);
    for (double side : {-1.0, 1.0}) {
      const auto corner = [&](const Station& p, const Station& q) {
        glm::dvec3 inner, n;
        inner[axis] = side * (box.half[axis] - radius);
        inner[a] = p.inner;
        inner[b] = q.inner;
        n[axis] = side;
        n[a] = p.lean;
        n[b] = q.lean;
        n = glm::normalize(n);
        glm::dvec3 position = box.centre + inner + radius * n;
        if (box.warp) {
          n = warped_normal(box.warp, position, n);
          position = box.warp(position);
        }
        return Corner{position, box.inward ? -n : n,
                      glm::dvec2(p.arc, q.arc) * box.tiles_per_metre};
      };
      for (std::size_t i = 0; i + 1 < along_a.size(); ++i)
        for (std::size_t j = 0; j + 1 < along_b.size(); ++j)
          builder.quad(corner(along_a[i], along_b[j]), corner(along_a[i + 1], along_b[j]),
                       corner(along_a[i + 1], along_b[j + 1]), corner(along_a[i], along_b[j + 1]));
    }
  }
}

void add_ring(Builder& builder, const Ring& ring) {
  const auto path = ring_path(builder, ring);
  const int around = 4 * builder.segments(ring.half.x, builder.coarse() ? 1 : 2);
  const auto corner = [&](std::size_t i, int j) {
    const double angle = 2 * kPi * (j + 0.5) / around, c = std::cos(angle), s = std::sin(angle);
    const glm::dvec2 out = path[i].outwards,
                     flat = path[i].place + out * (ring.half.x * power(c, 0.5));
    const glm::dvec3 place(flat.x, flat.y, ring.half.y * power(s, 0.5));
    // The gradient of the superellipse's equation.
    const double nx = power(c, 1.5) / ring.half.x, nz = power(s, 1.5) / ring.half.y;
    const glm::dvec3 normal = glm::normalize(glm::dvec3(out.x * nx, out.y * nx, nz));
    const glm::dvec2 uv(path[i].arc, 4 * ring.half.x * j / around);
    if (!ring.warp) return Corner{place, normal, uv * ring.tiles_per_metre};
    return Corner{ring.warp(place), warped_normal(ring.warp, place, normal),
                  uv * ring.tiles_per_metre};
  };
  for (std::size_t i = 0; i + 1 < path.size(); ++i)
    for (int j = 0; j < around; ++j)
      builder.quad(corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
}

void add_revolved(Builder& builder, const Revolved& body) {
  GridShape shape;
  shape.surface = [&](double u, double v) {
    const glm::dvec2 p = body.profile(std::clamp(v, 0.0, 1.0));
    return body.centre + glm::dvec3(p.x * std::cos(2 * kPi * u), p.x * std::sin(2 * kPi * u), p.y);
  };
  shape.nu = 4 * builder.segments(body.largest_radius * kPi / 2, builder.coarse() ? 1 : 2);
  shape.nv = builder.segments(body.height + body.largest_radius, builder.coarse() ? 3 : 6);
  add_grid(builder, shape);
}

}  // namespace cabin
