#include "examples/cabin/primitives.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace cabin {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kStep = 1e-5;  // of finite differences, in parameter or metre

// The normal after a warp: that of the images of two tangents.
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

// One coordinate of a rounded box's face: the inner box's coordinate, and the tangent of the angle
// by which the normal leans along it.
struct Station {
  double inner, lean, arc;
};

std::vector<Station> stations(const Builder& builder, double half, double radius,
                              int corner_least) {
  const int corner = std::max(corner_least, std::min(4, builder.segments(radius * kPi / 2)));
  const double flat = half - radius;
  const int middle = builder.segments(2 * flat);
  std::vector<Station> result;
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

// The perimeter of a rounded rectangle, anticlockwise from (half.x, 0), by arc length.
struct Outline {
  glm::dvec2 half;
  double radius;

  double length() const { return 4 * (half.x + half.y - 2 * radius) + 2 * kPi * radius; }
  glm::dvec2 at(double s) const {
    const glm::dvec2 flat = half - radius;
    const double quarter = kPi / 2 * radius, total = length();
    s -= total * std::floor(s / total);
    const double lengths[] = {flat.y,  quarter,    2 * flat.x, quarter, 2 * flat.y,
                              quarter, 2 * flat.x, quarter,    flat.y};
    int part = 0;
    while (part < 8 && s > lengths[part]) s -= lengths[part++];
    const double a = radius > 0 ? s / radius : 0;
    const auto arc = [&](double cx, double cy, double start) {
      return glm::dvec2(cx + radius * std::cos(start + a), cy + radius * std::sin(start + a));
    };
    switch (part) {
      case 0:
        return {half.x, s};
      case 1:
        return arc(flat.x, flat.y, 0);
      case 2:
        return {flat.x - s, half.y};
      case 3:
        return arc(-flat.x, flat.y, kPi / 2);
      case 4:
        return {-half.x, flat.y - s};
      case 5:
        return arc(-flat.x, -flat.y, kPi);
      case 6:
        return {-flat.x + s, -half.y};
      case 7:
        return arc(flat.x, -flat.y, 3 * kPi / 2);
      default:
        return {half.x, -flat.y + s};
    }
  }
};

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
      row[i] = {shape.surface(u, v), shape.flip ? -n : n, glm::dvec2(u, v) * shape.tiles};
    }
    for (int i = 0; j > 0 && i < shape.nu; ++i)
      builder.quad(previous[i], previous[i + 1], row[i + 1], row[i]);
    previous = row;
  }
}

void add_rounded_box(Builder& builder, const RoundedBox& box) {
  const double radius =
      std::min({box.radius, 0.999 * box.half.x, 0.999 * box.half.y, 0.999 * box.half.z});
  for (int axis = 0; axis < 3; ++axis) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    const auto along_a = stations(builder, box.half[a], radius, box.corner_least);
    const auto along_b = stations(builder, box.half[b], radius, box.corner_least);
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
  const Outline outline{ring.path_half, ring.path_radius};
  const double length = outline.length();
  const int along = 4 * builder.segments(length / 4, 4),
            around = 4 * builder.segments(ring.half.x, 2);
  GridShape shape;
  shape.surface = [&](double u, double v) {
    const glm::dvec2 p = outline.at(u * length);
    const glm::dvec2 tangent =
        glm::normalize(outline.at(u * length + 1e-4) - outline.at(u * length - 1e-4));
    const double x = ring.half.x * power(std::cos(2 * kPi * v), 0.5);
    const double z = ring.half.y * power(std::sin(2 * kPi * v), 0.5);
    const glm::dvec3 q(p.x + tangent.y * x, p.y - tangent.x * x, z);
    return ring.warp ? ring.warp(q) : q;
  };
  shape.nu = along;
  shape.nv = around;
  shape.tiles = glm::dvec2(length, 4 * ring.half.x) * ring.tiles_per_metre;
  add_grid(builder, shape);
}

void add_revolved(Builder& builder, const Revolved& body) {
  GridShape shape;
  shape.surface = [&](double u, double v) {
    const glm::dvec2 p = body.profile(std::clamp(v, 0.0, 1.0));
    return body.centre + glm::dvec3(p.x * std::cos(2 * kPi * u), p.x * std::sin(2 * kPi * u), p.y);
  };
  shape.nu = 4 * builder.segments(body.largest_radius * kPi / 2, 2);
  shape.nv = builder.segments(body.height + body.largest_radius, 6);
  add_grid(builder, shape);
}

}  // namespace cabin
