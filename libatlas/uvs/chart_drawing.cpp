#include "libatlas/uvs/chart_drawing.h"

#include <algorithm>
#include <bit>
#include <glm/common.hpp>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/raster/scan.h"
#include "libatlas/uvs/thin_uvs.h"

namespace atlas {
namespace {

std::int64_t twice_area(const std::array<glm::i64vec2, 3>& c) {
  const glm::i64vec2 u = c[1] - c[0], v = c[2] - c[0];
  return u.x * v.y - u.y * v.x;
}

TexelTriangle scaled(const std::array<glm::i64vec2, 3>& c, double by) {
  TexelTriangle p;
  for (int k = 0; k < 3; ++k) p[k] = {by * double(c[k].x), by * double(c[k].y)};
  return p;
}

constexpr int kLast = kDrawnSteps - 1;
constexpr Vec2d kCentre{0.5, 0.5};

}  // namespace

ChartDrawing::ChartDrawing(std::span<const std::uint32_t> corners, UvRange range,
                           std::span<const Vec2f> page_uvs, glm::dvec2 page)
    : uvs_(page_uvs.subspan(range.first, range.count)), page_(page) {
  corners_.reserve(corners.size());
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    const std::uint32_t a = corners[i], b = corners[i + 1], c = corners[i + 2];
    if (a == b || b == c || c == a) continue;
    for (const std::uint32_t corner : {a, b, c}) corners_.push_back(corner - range.first);
  }
}

std::span<const Vec2f> ChartDrawing::moved(glm::ivec2 steps) {
  const glm::dvec2 by = glm::dvec2(steps) / (double(kDrawnSteps) * page_);
  moved_.resize(uvs_.size());
  for (std::size_t i = 0; i < uvs_.size(); ++i) moved_[i] = rounded_uv(to_dvec(uvs_[i]) + by);
  return moved_;
}

std::size_t ChartDrawing::thin_triangles(glm::ivec2 steps) {
  moved(steps);
  const std::span<const std::uint32_t> corners = corners_;
  std::size_t thin = 0;
  for (std::size_t i = 0; i < corners.size(); i += 3)
    thin += is_thin(corners.subspan(i).first<3>(), moved_);
  return thin;
}

ChartDrawing::Snapped ChartDrawing::snapped(std::size_t triangle) const {
  const std::uint32_t* c = &corners_[3 * triangle];
  return {at_[c[0]], at_[c[1]], at_[c[2]]};
}

// Returns where the triangle's corners lie if those in doubt are rounded so that it has the least
// area.
ChartDrawing::Snapped ChartDrawing::turned_most(std::size_t triangle) const {
  Snapped least = snapped(triangle);
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::i8vec2 doubt = doubt_[corners_[3 * triangle + k]];
    for (int axis = 0; axis < 2; ++axis) {
      if (doubt[axis] == 0) continue;
      Snapped other = least;
      other[k][axis] += doubt[axis];
      if (twice_area(other) < twice_area(least)) least = other;
    }
  }
  return least;
}

// Calls visit() with the corners of the triangle where it is turned over, and where it may be.
template <class Visit>
void ChartDrawing::visit_turned(std::size_t triangle, const Visit& visit) const {
  const Snapped nominal = snapped(triangle), least = turned_most(triangle);
  if (twice_area(nominal) < 0) visit(nominal);
  if (least != nominal && twice_area(least) < 0) visit(least);
}

void ChartDrawing::snap() {
  at_.resize(uvs_.size());
  doubt_.resize(uvs_.size());
  const glm::dvec2 scale = page_ * double(kDrawnSteps), slack = kUvSlack * scale;
  for (std::size_t i = 0; i < uvs_.size(); ++i) {
    const glm::dvec2 p = to_dvec(moved_[i]) * scale + 0.5;
    at_[i] = glm::i64vec2(p);
    for (int axis = 0; axis < 2; ++axis) {
      const double above = p[axis] - double(at_[i][axis]);
      doubt_[i][axis] = above < slack[axis] ? -1 : above > 1 - slack[axis] ? 1 : 0;
    }
  }
}

std::size_t ChartDrawing::texels_drawn_twice(glm::ivec2 steps) {
  if (corners_.empty()) return 0;
  moved(steps);
  snap();
  // A step further, where corners in doubt may be rounded to, is no centre of another texel.
  glm::i64vec2 low = at_.front(), high = low;
  for (const glm::i64vec2& at : at_) {
    low = glm::min(low, at);
    high = glm::max(high, at);
  }
  box_ = {int(low.x >> kDrawnBits), int(low.y >> kDrawnBits), 0, 0};
  box_.width = int(high.x >> kDrawnBits) + 1 - box_.x;
  box_.height = int(high.y >> kDrawnBits) + 1 - box_.y;
  row_words_ = std::size_t(box_.width + 63) / 64;
  once_.assign(row_words_ * std::size_t(box_.height), 0);
  twice_.assign(once_.size(), 0);
  for (std::size_t t = 0; t < corners_.size() / 3; ++t) draw(t);
  std::size_t count = 0;
  for (const std::uint64_t word : twice_) count += std::size_t(std::popcount(word));
  return count;
}

// A triangle that is turned over lies on triangles that cover all of its texels already, so it
// draws all of them twice. Which of the texels on its edges it draws depends on which way up the
// page is drawn, so all of these count.
void ChartDrawing::draw(std::size_t triangle) {
  const Snapped c = snapped(triangle);
  if (twice_area(c) > 0) {
    scan_triangle<kDrawnBits>(scaled(c, 1.0 / kDrawnSteps), box_, kCentre,
                              [&](int y, int x0, int x1) { mark(y, x0, x1, false); });
  }
  visit_turned(triangle, [&](const Snapped& turned) {
    scan_triangle<kDrawnBits, EdgeRule::closed>(
        scaled(turned, 1.0 / kDrawnSteps), box_, kCentre,
        [&](int y, int x0, int x1) { mark(y, x0, x1, true); });
  });
}

void ChartDrawing::mark(int y, int x0, int x1, bool turned) {
  const std::size_t row = row_words_ * std::size_t(y - box_.y);
  const auto first = std::size_t(x0 - box_.x), last = std::size_t(x1 - 1 - box_.x);
  for (std::size_t w = first / 64; w <= last / 64; ++w) {
    std::uint64_t mask = ~std::uint64_t{0};
    if (w == first / 64) mask &= ~std::uint64_t{0} << (first % 64);
    if (w == last / 64) mask &= ~std::uint64_t{0} >> (63 - last % 64);
    twice_[row + w] |= turned ? mask : once_[row + w] & mask;
    once_[row + w] |= mask;
  }
}

std::vector<std::uint32_t> ChartDrawing::hits_of_turned() {
  std::vector<std::uint32_t> hits(std::size_t(kDrawnSteps) * kDrawnSteps, 0);
  texels_drawn_twice({0, 0});  // for at_
  const auto count = [&](const Snapped& c) {
    const auto [x_low, x_high] = std::minmax({c[0].x, c[1].x, c[2].x});
    const auto [y_low, y_high] = std::minmax({c[0].y, c[1].y, c[2].y});
    const Rect box{int(x_low), int(y_low), int(x_high - x_low) + 1, int(y_high - y_low) + 1};
    // A point of the grid of steps becomes a texel's centre if the chart is moved by half a texel
    // minus that point.
    scan_triangle<0, EdgeRule::closed>(scaled(c, 1), box, {0, 0}, [&](int y, int x0, int x1) {
      std::uint32_t* row = &hits[std::size_t((kDrawnSteps / 2 - y) & kLast) * kDrawnSteps];
      for (int x = x0; x < x1; ++x) ++row[(kDrawnSteps / 2 - x) & kLast];
    });
  };
  for (std::size_t t = 0; t < corners_.size() / 3; ++t) visit_turned(t, count);
  return hits;
}

}  // namespace atlas
