// Internal: finds the texels whose sample points lie in a triangle, exactly, by the fill rule of
// graphics hardware. Header-only, so that the caller's work per span is inlined.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <utility>

#include "libatlas/core/rect.h"
#include "libatlas/core/vec.h"

namespace atlas {

using TexelTriangle = std::array<Vec2d, 3>;  // corners in texels; texel (i, j) is [i,i+1]x[j,j+1]

// Corners are rounded to 2^kSubTexelBits steps a texel before the exact integer tests. Triangles
// that share a corner still share it after that.
inline constexpr int kSubTexelBits = 12;
// The largest coordinate that scan_triangle accepts. Beyond it the integer products would overflow.
inline constexpr double kMaxTexelCoordinate = 1 << 17;

// Which points on a triangle's edges belong to the triangle. With top_left, the rule of graphics
// hardware, a point on an edge shared by two triangles belongs to one of them. With closed, all
// points on the edges belong to the triangle.
enum class EdgeRule { top_left, closed };

namespace raster_detail {

// Nearest integer (ties to even) without a library call, for |x| < 2^51.
inline std::int64_t round_fixed(double x) {
  constexpr double kMagic = 0x1.8p52;
  return std::bit_cast<std::int64_t>(x + kMagic) - std::bit_cast<std::int64_t>(kMagic);
}

inline std::int64_t floor_div(std::int64_t a, std::int64_t b) {  // b > 0
  const std::int64_t q = a / b;
  return q - (a % b < 0);
}

// One directed edge of a counter-clockwise triangle. value() >= 0 means inside. For edges whose
// points do not belong to the triangle (edges that are neither left nor top), 1 is subtracted,
// which makes the test strict.
struct Edge {
  std::int64_t dx, dy, ax, ay, bias;

  Edge(const std::int64_t a[2], const std::int64_t b[2], EdgeRule rule)
      : dx(b[0] - a[0]), dy(b[1] - a[1]), ax(a[0]), ay(a[1]) {
    const bool left = dy < 0, top = dy == 0 && dx < 0;
    bias = left || top || rule == EdgeRule::closed ? 0 : -1;
  }
  std::int64_t value(std::int64_t x, std::int64_t y) const {
    return dx * (y - ay) - dy * (x - ax) + bias;
  }
};

// The floor of a value over the size of a slope, in a row and, without another division, in the
// rows after it. Tall triangles spend most of their time in these divisions otherwise.
class Quotient {
 public:
  // `step` is what the value grows by from row to row. Without a slope the floor is not used.
  Quotient(std::int64_t value, std::int64_t slope, std::int64_t step)
      : size_(slope < 0 ? -slope : slope) {
    if (size_ == 0) return;
    floor_ = floor_div(value, size_);
    rest_ = value - floor_ * size_;
    floor_step_ = floor_div(step, size_);
    rest_step_ = step - floor_step_ * size_;
  }
  std::int64_t floor() const { return floor_; }
  void next_row() {
    floor_ += floor_step_;
    rest_ += rest_step_;
    const std::int64_t carry = rest_ >= size_;
    floor_ += carry;
    rest_ -= carry * size_;
  }

 private:
  std::int64_t size_, floor_ = 0, rest_ = 0, floor_step_ = 0, rest_step_ = 0;
};

// Narrows [lo, hi] to the i with value + slope * i >= 0, where `floor` is that of value / |slope|.
inline void clip_span(std::int64_t value, std::int64_t slope, std::int64_t floor, std::int64_t& lo,
                      std::int64_t& hi) {
  if (slope > 0) {
    lo = std::max(lo, -floor);
  } else if (slope < 0) {
    hi = std::min(hi, floor);
  } else if (value < 0) {
    hi = lo - 1;
  }
}

// The values of a triangle's edges at the first sample point of a row, by how much they grow from
// point to point, and from row to row.
struct EdgeRows {
  std::int64_t value[3], slope[3], step[3];

  void next_row() {
    for (int k = 0; k < 3; ++k) value[k] += step[k];
  }
  bool outside(std::int64_t i) const {
    return ((value[0] + slope[0] * i) | (value[1] + slope[1] * i) | (value[2] + slope[2] * i)) < 0;
  }
};

// Calls give(y, lo, hi) for rows y with the range of points inside, of points 0 to `last`; hi < lo:
// none. Of a few points it tests each, which is cheaper than divisions.
template <class Give>
void scan_rows(EdgeRows rows, std::int64_t y_lo, std::int64_t y_hi, std::int64_t last,
               const Give& give) {
  constexpr std::int64_t kFew = 4;
  if (last < kFew) {
    for (std::int64_t y = y_lo; y <= y_hi; ++y, rows.next_row()) {
      std::int64_t lo = 0, hi = last;
      while (lo <= hi && rows.outside(lo)) ++lo;
      while (hi >= lo && rows.outside(hi)) --hi;
      give(y, lo, hi);
    }
    return;
  }
  const auto quotient = [&](int k) { return Quotient(rows.value[k], rows.slope[k], rows.step[k]); };
  Quotient quotients[3] = {quotient(0), quotient(1), quotient(2)};
  for (std::int64_t y = y_lo; y <= y_hi; ++y, rows.next_row()) {
    std::int64_t lo = 0, hi = last;
    for (int k = 0; k < 3; ++k) {
      clip_span(rows.value[k], rows.slope[k], quotients[k].floor(), lo, hi);
      quotients[k].next_row();
    }
    give(y, lo, hi);
  }
}

}  // namespace raster_detail

// Calls span(y, x0, x1) for each row of `clip` in which sample points lie inside the triangle,
// which may have either orientation. The sample points are (x + offset.x, y + offset.y) with x0 <=
// x < x1. With the top-left rule a point on an edge shared by two triangles belongs to exactly one
// of them. A triangle without area has no points. Coordinates must be finite and within
// kMaxTexelCoordinate. They are rounded to 2^bits steps a texel, and coordinates times 2^bits must
// be at most 2^29.
template <int bits = kSubTexelBits, EdgeRule rule = EdgeRule::top_left, class Span>
void scan_triangle(const TexelTriangle& p, const Rect& clip, Vec2d offset, Span&& span) {
  using namespace raster_detail;
  constexpr std::int64_t kOne = std::int64_t{1} << bits;
  std::int64_t v[3][2];
  for (int k = 0; k < 3; ++k) {
    v[k][0] = round_fixed((p[k].x - offset.x) * kOne);
    v[k][1] = round_fixed((p[k].y - offset.y) * kOne);
  }
  const std::int64_t area =
      (v[1][0] - v[0][0]) * (v[2][1] - v[0][1]) - (v[1][1] - v[0][1]) * (v[2][0] - v[0][0]);
  if (area == 0) return;
  if (area < 0) std::swap(v[1], v[2]);
  const auto up = [](std::int64_t a) { return (a + kOne - 1) >> bits; };
  const auto down = [](std::int64_t a) { return a >> bits; };
  const std::int64_t x_lo =
      std::max<std::int64_t>(clip.x, up(std::min({v[0][0], v[1][0], v[2][0]})));
  const std::int64_t x_hi =
      std::min<std::int64_t>(clip.right() - 1, down(std::max({v[0][0], v[1][0], v[2][0]})));
  const std::int64_t y_lo =
      std::max<std::int64_t>(clip.y, up(std::min({v[0][1], v[1][1], v[2][1]})));
  const std::int64_t y_hi =
      std::min<std::int64_t>(clip.top() - 1, down(std::max({v[0][1], v[1][1], v[2][1]})));
  if (x_lo > x_hi || y_lo > y_hi) return;

  const Edge edge[3] = {Edge(v[0], v[1], rule), Edge(v[1], v[2], rule), Edge(v[2], v[0], rule)};
  EdgeRows rows;
  for (int k = 0; k < 3; ++k) {
    rows.value[k] = edge[k].value(x_lo * kOne, y_lo * kOne);
    rows.slope[k] = -edge[k].dy * kOne;
    rows.step[k] = edge[k].dx * kOne;
  }
  scan_rows(rows, y_lo, y_hi, x_hi - x_lo, [&](std::int64_t y, std::int64_t lo, std::int64_t hi) {
    if (lo <= hi)
      span(static_cast<int>(y), static_cast<int>(x_lo + lo), static_cast<int>(x_lo + hi + 1));
  });
}

}  // namespace atlas
