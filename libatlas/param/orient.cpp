#include "libatlas/param/orient.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "libatlas/core/bounds.h"
#include "libatlas/core/degrees.h"
#include "libatlas/core/portable_math.h"
#include "libatlas/core/predicates.h"
#include "libatlas/core/sort_total.h"
#include "libatlas/param/mesh/rest_shape.h"

namespace atlas {
namespace {

using param::cross;

// Keeps the points that may be on the hull: those not inside the quadrilateral of the extreme
// points.
std::vector<Vec2d> hull_candidates(std::span<const Vec2d> points) {
  std::array<Vec2d, 4> corner = {points[0], points[0], points[0], points[0]};
  for (const Vec2d p : points) {
    if (p.x + p.y < corner[0].x + corner[0].y) corner[0] = p;
    if (p.x - p.y > corner[1].x - corner[1].y) corner[1] = p;
    if (p.x + p.y > corner[2].x + corner[2].y) corner[2] = p;
    if (p.x - p.y < corner[3].x - corner[3].y) corner[3] = p;
  }
  std::vector<Vec2d> kept;
  for (const Vec2d p : points) {
    bool inside = true;
    for (int k = 0; k < 4 && inside; ++k) {
      const glm::dvec2 a = to_glm(corner[k]), b = to_glm(corner[(k + 1) % 4]);
      inside = cross(b - a, to_glm(p) - a) > 0;
    }
    if (!inside) kept.push_back(p);
  }
  return kept;
}

// Returns the convex hull, counter-clockwise and without collinear points, starting at the
// lexicographically lowest point (Andrew 1979, monotone chain).
std::vector<Vec2d> convex_hull(std::span<const Vec2d> points) {
  std::vector<Vec2d> p = hull_candidates(points);
  sort_total(p.begin(), p.end(),
             [](Vec2d a, Vec2d b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  p.erase(std::unique(p.begin(), p.end()), p.end());
  if (p.size() < 3) return p;
  std::vector<Vec2d> hull(2 * p.size());
  std::size_t k = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    while (k >= 2 && orientation(hull[k - 2], hull[k - 1], p[i]) <= 0) --k;
    hull[k++] = p[i];
  }
  const std::size_t lower = k + 1;
  for (std::size_t i = p.size() - 1; i-- > 0;) {
    while (k >= lower && orientation(hull[k - 2], hull[k - 1], p[i]) <= 0) --k;
    hull[k++] = p[i];
  }
  hull.resize(k - 1);
  return hull;
}

// Returns the points that the hull is made of: the starts of border edges, each corner of a loop
// once.
std::vector<Vec2d> outline(std::span<const Vec2d> uvs,
                           std::span<const std::array<std::uint32_t, 2>> edges) {
  if (edges.empty()) return {uvs.begin(), uvs.end()};
  std::vector<Vec2d> points;
  points.reserve(edges.size());
  for (const auto& edge : edges) points.push_back(uvs[edge[0]]);
  return points;
}

using UvBox = Bounds<glm::dvec2>;

double area_of(const UvBox& box) {
  return box.size().x * box.size().y;
}

// Returns the box of the points in the frame whose first axis is the unit vector d.
UvBox box_along(std::span<const Vec2d> points, glm::dvec2 d) {
  UvBox box;
  for (const Vec2d p : points) box.add({d.x * p.x + d.y * p.y, d.x * p.y - d.y * p.x});
  return box;
}

// Returns the direction of the hull edge with the smallest box. The calipers move their three other
// contacts only forward, so all edges together take O(hull).
glm::dvec2 smallest_box(const std::vector<Vec2d>& hull) {
  const std::size_t n = hull.size();
  if (n < 2) return {1, 0};
  if (n == 2) return glm::normalize(to_glm(hull[1]) - to_glm(hull[0]));
  const auto at = [&](std::size_t i) { return to_glm(hull[i % n]); };
  glm::dvec2 best(1, 0);
  double best_area = std::numeric_limits<double>::infinity();
  std::size_t right = 1, top = 1, left = 1;
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec2 d = glm::normalize(at(i + 1) - at(i)), up(-d.y, d.x);
    right = std::max(right, i + 1);
    while (glm::dot(at(right + 1) - at(right), d) > 0) ++right;
    top = std::max(top, right);
    while (glm::dot(at(top + 1) - at(top), up) > 0) ++top;
    left = std::max(left, top);
    while (glm::dot(at(left + 1) - at(left), d) < 0) ++left;
    const double area = glm::dot(at(right) - at(left), d) * glm::dot(at(top) - at(i), up);
    if (area < best_area * (1 - 1e-12)) {
      best_area = area;
      best = d;
    }
  }
  return best;
}

// At four times the angle, directions that are equal modulo 90 degrees add up.
struct BorderEdge {
  double length;
  glm::dvec2 quadrupled;  // unit vector at four times the edge's angle
};

std::vector<BorderEdge> border_directions(std::span<const Vec2d> uvs,
                                          std::span<const std::array<std::uint32_t, 2>> edges) {
  const auto doubled = [](glm::dvec2 d) {
    return glm::dvec2(d.x * d.x - d.y * d.y, 2 * d.x * d.y);
  };
  std::vector<BorderEdge> out;
  out.reserve(edges.size());
  for (const auto& [a, b] : edges) {
    const glm::dvec2 e = to_glm(uvs[b]) - to_glm(uvs[a]);
    const double length = glm::length(e);
    if (length > 0) out.push_back({length, doubled(doubled(e / length))});
  }
  return out;
}

// Returns the mean direction, modulo 90 degrees, of the edges near `angle`, over narrower and
// narrower windows, so that long straight borders outweigh those that are only nearly straight.
glm::dvec2 refine_direction(std::span<const BorderEdge> edges, double angle) {
  for (const double window : {0.5, 0.1, 0.02}) {
    const double limit = portable::cos(4 * radians(window));
    const glm::dvec2 middle(portable::cos(4 * angle), portable::sin(4 * angle));
    double c = 0, s = 0;
    for (const BorderEdge& e : edges) {
      const double cosine = glm::dot(middle, e.quadrupled);
      if (!(cosine >= limit)) continue;
      c += e.length * cosine;
      s += e.length * cross(middle, e.quadrupled);
    }
    if (c > 0) angle += portable::atan2(s, c) / 4;
  }
  return {portable::cos(angle), portable::sin(angle)};
}

// Finds the direction, modulo 90 degrees, with the largest border length. Returns false if that is
// too little.
bool straight_direction(std::span<const BorderEdge> edges, glm::dvec2* out) {
  constexpr int bins = 180;  // of half a degree each
  std::array<double, bins> length{};
  double total = 0;
  for (const BorderEdge& e : edges) {
    double turn = portable::atan2(e.quadrupled.y, e.quadrupled.x) / (2 * std::numbers::pi);
    turn -= std::floor(turn);
    length[std::min(static_cast<int>(turn * bins), bins - 1)] += e.length;
    total += e.length;
  }
  int best = 0;  // the pair of neighbouring bins best, best + 1
  const auto pair = [&](int k) { return length[k] + length[(k + 1) % bins]; };
  for (int k = 1; k < bins; ++k) {
    if (pair(k) > pair(best)) best = k;
  }
  if (!(pair(best) >= 0.2 * total) || !(total > 0)) return false;
  *out = refine_direction(edges, (best + 1) * 0.5 * std::numbers::pi / bins);
  return true;
}

}  // namespace

Orientation orient_for_packing(std::span<Vec2d> uvs,
                               std::span<const std::array<std::uint32_t, 2>> border_edges,
                               double straight_slack) {
  Orientation out;
  if (uvs.empty()) return out;
  const std::vector<Vec2d> hull = convex_hull(outline(uvs, border_edges));
  glm::dvec2 d = smallest_box(hull);
  UvBox box = box_along(hull, d);
  glm::dvec2 straight;
  if (straight_direction(border_directions(uvs, border_edges), &straight)) {
    const UvBox other = box_along(hull, straight);
    if (area_of(other) <= area_of(box) * (1 + straight_slack)) {
      d = straight;
      box = other;
    }
  }
  if (box.size().y > box.size().x) {
    d = {-d.y, d.x};
    box = box_along(hull, d);
  }
  for (Vec2d& p : uvs) {
    // Rounding may put a point slightly outside of the box, hence the max.
    p = {std::max(d.x * p.x + d.y * p.y - box.low.x, 0.0),
         std::max(d.x * p.y - d.y * p.x - box.low.y, 0.0)};
  }
  out.cosine = d.x;
  out.sine = -d.y;
  out.size = from_glm(box.size());
  return out;
}

}  // namespace atlas
