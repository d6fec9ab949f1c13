#include "libatlas/simplify/star.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libatlas/core/predicates.h"

namespace atlas::simplify {
namespace {

// Weight of an edge's length (in texels) against slip (in units of the bound). It spreads the
// vertices of flat parts evenly, and is small enough that slip decides on curved parts.
constexpr double kLengthWeight = 0.02;
// A needle of quality q costs 1 + kNeedle / q times as much.
constexpr double kNeedle = 0.1;
// No triangle of lower quality than kThinnest arises where there was none before (1 is equilateral,
// 0 has no area). A strip with sides of one to ten thousand is still allowed. Where there was a
// thinner one before, its quality is the limit, but at least kNoArea.
constexpr double kThinnest = 2e-4, kNoArea = 1e-7;
// If a vertex has more than kManyNeighbours neighbours, only the kNearest nearest are tried as
// targets.
constexpr std::size_t kManyNeighbours = 14, kNearest = 8;

bool turns_left(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return orientation(from_glm(a), from_glm(b), from_glm(c)) > 0;
}

double cross2(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

double quality(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, double twice_area) {
  const glm::dvec3 x = b - a, y = c - b, z = a - c;
  const double squares = glm::dot(x, x) + glm::dot(y, y) + glm::dot(z, z);
  return squares > 0 ? 3.4641016151377544 * twice_area / squares : 0;
}

}  // namespace

void Star::measure_faces() {
  normals.clear();
  worst_quality = 1;
  for (std::size_t i = 0; i < ring.faces.size(); ++i) {
    const glm::dvec3 &a = positions[i], &b = positions[after(i)];
    const glm::dvec3 normal = glm::cross(a - position, b - position);
    const double length = glm::length(normal);
    normals.push_back(length > 0 ? normal / length : glm::dvec3(0));
    worst_quality = std::min(worst_quality, quality(position, a, b, length));
  }
}

// Finds the new triangle that contains v's uv, and sets `offset` to the gap there. Returns false if
// there is no new triangle.
bool Star::locate(std::size_t target, double texel, Estimate& out) const {
  double best = -std::numeric_limits<double>::infinity();
  const glm::dvec2& o = uvs[target];
  for (std::size_t i = 0; i < ring.faces.size(); ++i) {
    if (!keeps(i, target)) continue;
    const std::size_t j = after(i);
    const glm::dvec2 a = uvs[i] - o, b = uvs[j] - o, d = uv - o;
    const double det = cross2(a, b), x = cross2(d, b) / det, y = cross2(a, d) / det;
    const double inside = std::min({x, y, 1 - x - y});
    if (inside <= best) continue;
    best = inside;
    const glm::dvec3 &p = positions[target], e = positions[i] - p, f = positions[j] - p;
    out.offset = glm::length(p + x * e + y * f - position) / texel;
  }
  constexpr double kRounding = 1e-9;
  out.outside = ring.border && best < -kRounding;
  return best > -std::numeric_limits<double>::infinity();
}

bool Star::judge(std::size_t target, double texel, double slip_bound, Estimate& out) const {
  const glm::dvec2& to_uv = uvs[target];
  const glm::dvec3& to = positions[target];
  const double thinnest = std::clamp(worst_quality, kNoArea, kThinnest);
  double worst = 1;
  for (std::size_t i = 0; i < ring.faces.size(); ++i) {
    if (!keeps(i, target)) continue;
    const std::size_t j = after(i);
    if (!turns_left(to_uv, uvs[i], uvs[j])) return false;
    const glm::dvec3 normal = glm::cross(positions[i] - to, positions[j] - to);
    const double length = glm::length(normal);
    const double q = quality(to, positions[i], positions[j], length);
    if (q < thinnest || !(length > 0)) return false;
    if (normals[i] != glm::dvec3(0) && glm::dot(normal, normals[i]) <= 0) return false;
    worst = std::min(worst, q);
  }
  if (!locate(target, texel, out)) return false;  // no triangle would be left
  out.v = vertex;
  out.w = ring.vertices[target];
  const double slip = out.outside ? 0 : out.offset / slip_bound;
  const double length = kLengthWeight * glm::length(to - position) / texel;
  out.cost = (slip * slip + length * length) * (1 + kNeedle / worst);
  return true;
}

double Star::step_slip(std::size_t target) const {
  const std::size_t n = size();
  double worst = 0;
  const glm::dvec2 &o = uvs[target], go = o - uv;
  for (std::size_t j = 0; j < n; ++j) {
    const bool beside = after(j) == target || after(target) == j;
    const bool new_border = ring.border && (j == 0 || j + 1 == n);
    if (j == target || (beside && !new_border)) continue;
    const glm::dvec2 come = uvs[j] - o;
    for (std::size_t i = 0; i < n; ++i) {
      if (i == target || i == j) continue;
      const glm::dvec2 go_i = uvs[i] - uv;
      const double det = cross2(go_i, come);
      if (det == 0) continue;
      const double s = cross2(go, come) / det, t = cross2(go, go_i) / det;
      if (s <= 0 || s >= 1 || t <= 0 || t >= 1) continue;
      const glm::dvec3 before = position + s * (positions[i] - position);
      const glm::dvec3 after = positions[target] + t * (positions[j] - positions[target]);
      worst = std::max(worst, glm::length(after - before));
    }
  }
  return worst;
}

double Star::step_turn(std::size_t target) const {
  double least = 1;
  for (std::size_t i = 0; i < ring.faces.size(); ++i) {
    if (!keeps(i, target)) continue;
    const glm::dvec3& p = positions[target];
    const glm::dvec3 normal = glm::normalize(glm::cross(positions[i] - p, positions[after(i)] - p));
    for (const glm::dvec3& old : normals) {
      if (old != glm::dvec3(0)) least = std::min(least, glm::dot(normal, old));
    }
  }
  return std::acos(std::max(least, -1.0));
}

void Star::pick_targets(std::vector<std::size_t>& out) const {
  out.clear();
  for (std::size_t i = 0; i < size(); ++i) out.push_back(i);
  if (out.size() <= kManyNeighbours) return;
  const auto distance = [&](std::size_t i) {
    const glm::dvec3 d = positions[i] - position;
    return glm::dot(d, d);
  };
  std::partial_sort(out.begin(), out.begin() + kNearest, out.end(),
                    [&](std::size_t a, std::size_t b) {
                      const double x = distance(a), y = distance(b);
                      return x != y ? x < y : a < b;
                    });
  out.resize(kNearest);
}

}  // namespace atlas::simplify
