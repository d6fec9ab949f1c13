#include "libatlas/simplify/slip_measure.h"

#include <algorithm>
#include <cmath>

#include "libatlas/core/glm_bridge.h"

namespace atlas::simplify {
namespace {

// Strips narrower than this share of the slip's bound do not count for the turn. Along a crease,
// uvs are straight only up to the solver's tolerance, so a triangle on one side of the crease
// covers a sliver of the other side.
constexpr double kStrip = 0.1;

// A point of the clipped piece: its barycentric coordinates in the coarse triangle, and the gap
// between the two surfaces there.
struct Sample {
  double b[3];
  glm::dvec3 gap;
};

Sample between(const Sample& p, const Sample& q, double t) {
  Sample r;
  for (int k = 0; k < 3; ++k) r.b[k] = p.b[k] + t * (q.b[k] - p.b[k]);
  r.gap = p.gap + t * (q.gap - p.gap);
  return r;
}

// A fine triangle clipped by sides of the coarse triangle: a convex polygon.
struct Piece {
  Sample points[8];
  int count = 0;

  void clip(int side) {
    Sample kept[8];
    int n = 0;
    for (int i = 0; i < count; ++i) {
      const Sample &p = points[i], &q = points[(i + 1) % count];
      if (p.b[side] >= 0) kept[n++] = p;
      if ((p.b[side] >= 0) != (q.b[side] >= 0)) {
        kept[n++] = between(p, q, p.b[side] / (p.b[side] - q.b[side]));
      }
    }
    count = n;
    std::copy(kept, kept + n, points);
  }
  double area() const {
    double twice = 0;
    for (int i = 0; i < count; ++i) {
      const Sample &p = points[i], &q = points[(i + 1) % count];
      twice += p.b[0] * q.b[1] - p.b[1] * q.b[0];
    }
    return std::abs(twice);
  }
  // The largest gap between the two surfaces: they are linear, so it is at a corner.
  double gap() const {
    double squared = 0;
    for (int i = 0; i < count; ++i)
      squared = std::max(squared, glm::dot(points[i].gap, points[i].gap));
    return std::sqrt(squared);
  }
  // The area in space divided by the longest side, on a coarse triangle with the edges e1 and e2.
  double width(const glm::dvec3& e1, const glm::dvec3& e2) const {
    double longest = 0;
    for (int i = 0; i < count; ++i) {
      const Sample &p = points[i], &q = points[(i + 1) % count];
      longest = std::max(longest, glm::length((q.b[1] - p.b[1]) * e1 + (q.b[2] - p.b[2]) * e2));
    }
    return area() * glm::length(glm::cross(e1, e2)) / (2 * longest);
  }
};

}  // namespace

struct SlipMeasure::Coarse {
  glm::dvec2 origin, du, dv;  // rows of the map from uv to the last two barycentric coordinates
  glm::dvec3 p0, e1, e2, normal;
};

SlipMeasure::SlipMeasure(const FineChart& fine, const VertexPoints& points)
    : fine_(fine), points_(points), stamp_(fine.triangle_count(), 0) {}

void SlipMeasure::push(std::uint32_t triangle) {
  if (stamp_[triangle] == epoch_) return;
  stamp_[triangle] = epoch_;
  stack_.push_back(triangle);
}

void SlipMeasure::push_fan(std::uint32_t vertex) {
  const std::uint32_t start = fine_.vertex_half[vertex];
  std::uint32_t h = start;
  do {
    push(h / 3);
    h = fine_.opposite[previous_half_edge(h)];
  } while (h != kNoIndex && h != start);
}

bool SlipMeasure::visit(std::uint32_t triangle, const Coarse& coarse, const SlipLimits& limits,
                        SlipLimits& found) {
  const std::uint32_t* corners = &fine_.corners[std::size_t{3} * triangle];
  Piece piece;
  piece.count = 3;
  for (int k = 0; k < 3; ++k) {
    const glm::dvec2 d = to_glm(points_.uvs[corners[k]]) - coarse.origin;
    Sample& s = piece.points[k];
    s.b[1] = glm::dot(coarse.du, d);
    s.b[2] = glm::dot(coarse.dv, d);
    s.b[0] = 1 - s.b[1] - s.b[2];
  }
  constexpr double kTouch = 1e-12;  // thinner pieces are rounding; neighbours cover them
  bool across[3];
  for (int side = 0; side < 3; ++side) {
    const double b0 = piece.points[0].b[side], b1 = piece.points[1].b[side],
                 b2 = piece.points[2].b[side];
    if (std::max({b0, b1, b2}) <= kTouch) return true;
    across[side] = std::min({b0, b1, b2}) < 0;
  }
  glm::dvec3 p[3];
  for (int k = 0; k < 3; ++k) {
    p[k] = to_dvec(points_.positions[corners[k]]);
    Sample& s = piece.points[k];
    s.gap = coarse.p0 + s.b[1] * coarse.e1 + s.b[2] * coarse.e2 - p[k];
  }
  for (int side = 0; side < 3; ++side)
    if (across[side]) piece.clip(side);
  if (piece.count == 0) return true;
  // A piece without area adds nothing, but the chart goes on behind it: triangles without area in
  // uv close T-junctions, and rows of them must not hide what lies between them.
  if (const double area = piece.area(); area > kTouch * kTouch) {
    covered_ += area;
    const glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
    found.slip = std::max(found.slip, piece.gap());
    if (found.slip > limits.slip) return false;
    const double length = glm::length(normal), c = glm::dot(normal, coarse.normal);
    if (length > 0 && c / length < turn_cosine_ &&
        piece.width(coarse.e1, coarse.e2) > kStrip * limits.slip) {
      turn_cosine_ = c / length;
      found.turn = std::acos(std::max(turn_cosine_, -1.0));
    }
    if (found.turn > limits.turn) return false;
  }
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t other = fine_.opposite[std::size_t{3} * triangle + k];
    if (other != kNoIndex) push(other / 3);
  }
  return true;
}

bool SlipMeasure::measure(const std::array<std::uint32_t, 3>& triangle, const SlipLimits& limits,
                          SlipLimits& found) {
  glm::dvec2 uv[3];
  glm::dvec3 p[3];
  bool at_border = false;
  for (int k = 0; k < 3; ++k) {
    uv[k] = to_glm(points_.uvs[triangle[k]]);
    p[k] = to_dvec(points_.positions[triangle[k]]);
    at_border = at_border || fine_.border(triangle[k]);
  }
  Coarse coarse;
  const glm::dvec2 a = uv[1] - uv[0], b = uv[2] - uv[0];
  const double det = a.x * b.y - a.y * b.x;
  coarse.origin = uv[0];
  coarse.du = glm::dvec2(b.y, -b.x) / det;
  coarse.dv = glm::dvec2(-a.y, a.x) / det;
  coarse.p0 = p[0];
  coarse.e1 = p[1] - p[0];
  coarse.e2 = p[2] - p[0];
  coarse.normal = glm::normalize(glm::cross(coarse.e1, coarse.e2));
  found = {};
  turn_cosine_ = 1;
  covered_ = 0;
  ++epoch_;
  stack_.clear();
  for (const std::uint32_t v : triangle) push_fan(v);
  while (!stack_.empty()) {
    const std::uint32_t next = stack_.back();
    stack_.pop_back();
    if (!visit(next, coarse, limits, found)) return false;
  }
  constexpr double kCoverage = 1e-6;  // allows for rounding of the sum of clipped areas
  return at_border || covered_ > 1 - kCoverage;
}

}  // namespace atlas::simplify
