#include "libatlas/scene/polygon.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

constexpr std::size_t kMaxConcave = 4096;  // ear clipping is quadratic

double cross2(Vec2d a, Vec2d b, Vec2d c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Drops the coordinate along which the polygon's normal is largest and keeps it counter-clockwise.
std::vector<Vec2d> project(std::span<const Vec3d> corners) {
  glm::dvec3 normal(0);
  const glm::dvec3 base = to_glm(corners[0]);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 a = to_glm(corners[i]) - base;
    const glm::dvec3 b = to_glm(corners[(i + 1) % corners.size()]) - base;
    normal += glm::cross(a, b);
  }
  const glm::dvec3 size = glm::abs(normal);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::vector<Vec2d> flat;
  flat.reserve(corners.size());
  for (const Vec3d& corner : corners) {
    const glm::dvec3 p = to_glm(corner) - base;
    Vec2d q{p[(axis + 1) % 3], p[(axis + 2) % 3]};
    if (normal[axis] < 0) std::swap(q.x, q.y);
    flat.push_back(q);
  }
  return flat;
}

// Turns left at every corner and goes round once.
bool convex(const std::vector<Vec2d>& p) {
  int sign_changes = 0;
  double last = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec2d &a = p[i], &b = p[(i + 1) % p.size()], &c = p[(i + 2) % p.size()];
    if (cross2(a, b, c) < 0) return false;
    const double step = b.x - a.x;
    if (step == 0) continue;
    if (last != 0 && (step > 0) != (last > 0)) ++sign_changes;
    last = step;
  }
  return sign_changes <= 2;  // a polygon that winds twice changes direction more often
}

bool inside(Vec2d a, Vec2d b, Vec2d c, Vec2d p) {
  return cross2(a, b, p) >= 0 && cross2(b, c, p) >= 0 && cross2(c, a, p) >= 0;
}

bool is_ear(const std::vector<Vec2d>& p, const std::vector<std::uint32_t>& ring, std::size_t i) {
  const std::size_t n = ring.size();
  const std::uint32_t ia = ring[(i + n - 1) % n], ib = ring[i], ic = ring[(i + 1) % n];
  if (cross2(p[ia], p[ib], p[ic]) <= 0) return false;
  return std::none_of(ring.begin(), ring.end(), [&](std::uint32_t k) {
    if (k == ia || k == ib || k == ic) return false;
    if (p[k] == p[ia] || p[k] == p[ib] || p[k] == p[ic]) return false;
    return inside(p[ia], p[ib], p[ic], p[k]);
  });
}

void clip_ears(const std::vector<Vec2d>& p, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::vector<std::uint32_t> ring(p.size());
  std::iota(ring.begin(), ring.end(), 0u);
  std::size_t next = 1;  // going on after the last ear avoids long slivers at one corner
  while (ring.size() > 3) {
    const std::size_t n = ring.size();
    std::size_t ear = next % n;
    for (std::size_t tries = 0; tries < n; ++tries) {
      const std::size_t i = (next + tries) % n;
      if (!is_ear(p, ring, i)) continue;
      ear = i;
      break;
    }
    triangles.push_back({ring[(ear + n - 1) % n], ring[ear], ring[(ear + 1) % n]});
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(ear));
    next = ear + 1;
  }
  triangles.push_back({ring[0], ring[1], ring[2]});
}

}  // namespace

bool triangulate(std::span<const Vec3d> corners,
                 std::vector<std::array<std::uint32_t, 3>>& triangles) {
  triangles.clear();
  const auto n = static_cast<std::uint32_t>(corners.size());
  const std::vector<Vec2d> flat = n > 3 ? project(corners) : std::vector<Vec2d>{};
  const bool fan = n == 3 || convex(flat);
  if (!fan && n <= kMaxConcave) {
    clip_ears(flat, triangles);
    return true;
  }
  for (std::uint32_t i = 1; i + 1 < n; ++i) triangles.push_back({0, i, i + 1});
  return fan;
}

}  // namespace atlas
