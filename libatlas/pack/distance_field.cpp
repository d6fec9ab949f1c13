#include "libatlas/pack/distance_field.h"

#include <algorithm>
#include <cmath>

namespace atlas::pack {
namespace {

// Squared distances in cells to the nearest cell of value 0, exactly: lower envelopes of parabolas
// along the columns, then along the rows (Felzenszwalb and Huttenlocher 2012).
class SquaredDistances {
 public:
  SquaredDistances(int width, int height, std::vector<float>& grid) : grid_(grid) {
    const auto longest = static_cast<std::size_t>(std::max(width, height));
    line_.resize(longest);
    apex_.resize(longest);
    border_.resize(longest + 1);
    for (int x = 0; x < width; ++x) transform(std::size_t(x), std::size_t(width), height);
    for (int y = 0; y < height; ++y) transform(std::size_t(y) * std::size_t(width), 1, width);
  }
  static constexpr float kFar = 1e12f;

 private:
  void transform(std::size_t first, std::size_t step, int count) {
    for (int i = 0; i < count; ++i) line_[std::size_t(i)] = grid_[first + step * std::size_t(i)];
    int k = -1;
    for (int q = 0; q < count; ++q) {
      const float f = line_[std::size_t(q)];
      if (f >= kFar) continue;
      float cut = -kFar;
      for (; k >= 0; --k) {
        const int p = apex_[std::size_t(k)];
        cut = (f - line_[std::size_t(p)] + float(q * q - p * p)) / float(2 * (q - p));
        if (cut > border_[std::size_t(k)]) break;
      }
      if (k < 0) cut = -kFar;
      ++k;
      apex_[std::size_t(k)] = q;
      border_[std::size_t(k)] = cut;
    }
    const int last = k;
    if (last < 0) return;
    k = 0;
    for (int q = 0; q < count; ++q) {
      while (k < last && border_[std::size_t(k) + 1] < float(q)) ++k;
      const int p = apex_[std::size_t(k)];
      grid_[first + step * std::size_t(q)] = float((q - p) * (q - p)) + line_[std::size_t(p)];
    }
  }

  std::vector<float>& grid_;
  std::vector<float> line_, border_;
  std::vector<int> apex_;
};

}  // namespace

DistanceField::DistanceField(const Mask& mask, double cell, double reach) {
  const int margin = static_cast<int>(std::ceil(reach / cell)) + 1;
  width_ = mask.width + 2 * margin;
  height_ = mask.height + 2 * margin;
  inverse_ = 1 / cell;
  shift_ = margin - 0.5;
  const std::size_t count = std::size_t(width_) * std::size_t(height_);
  values_.assign(count, SquaredDistances::kFar);
  std::vector<float> inside(count, 0.f);
  for (std::int32_t r = 0; r < mask.height; ++r)
    for (const Run& run : mask.row(r)) {
      const std::size_t row = std::size_t(r + margin) * std::size_t(width_) + std::size_t(margin);
      std::fill(values_.begin() + std::ptrdiff_t(row + std::size_t(run.begin)),
                values_.begin() + std::ptrdiff_t(row + std::size_t(run.end)), 0.f);
      std::fill(inside.begin() + std::ptrdiff_t(row + std::size_t(run.begin)),
                inside.begin() + std::ptrdiff_t(row + std::size_t(run.end)),
                SquaredDistances::kFar);
    }
  SquaredDistances(width_, height_, values_);
  SquaredDistances(width_, height_, inside);
  for (std::size_t i = 0; i < count; ++i) {
    // From centre to centre; the mask's edge lies half a cell before, the chart's another half.
    const double d = inside[i] > 0 ? 1.0 - std::sqrt(double(inside[i])) : std::sqrt(values_[i]);
    values_[i] = static_cast<float>(d * cell);
  }
}

// One step along the gradient.
Vec2d DistanceField::onto_outline(Vec2d p) const {
  Sample s, ahead;
  const double h = 0.5 / inverse_;  // from a cell's centre: the mean of both sides
  if (!sample({p.x - h, p.y - h}, s) || !sample({p.x + h, p.y + h}, ahead)) return p;
  const Vec2d g{s.gradient.x + ahead.gradient.x, s.gradient.y + ahead.gradient.y};
  const double length = std::hypot(g.x, g.y);
  if (length < 1e-9 || !sample(p, s)) return p;
  return {p.x - s.distance * g.x / length, p.y - s.distance * g.y / length};
}

std::vector<Vec2d> DistanceField::outline(double spacing) const {
  std::vector<Vec2d> points;
  const double cell = 1 / inverse_;
  const int block = std::max(1, static_cast<int>(spacing / cell));
  for (int by = 0; by < height_; by += block)
    for (int bx = 0; bx < width_; bx += block) {
      double nearest = 0.75 * cell;
      Vec2d best;
      for (int y = by; y < std::min(by + block, height_); ++y)
        for (int x = bx; x < std::min(bx + block, width_); ++x) {
          const double d = values_[std::size_t(y) * std::size_t(width_) + std::size_t(x)];
          if (std::abs(d) >= nearest) continue;
          nearest = std::abs(d);
          best = {(x - shift_) * cell, (y - shift_) * cell};
        }
      if (nearest < 0.75 * cell) points.push_back(onto_outline(best));
    }
  return points;
}

}  // namespace atlas::pack
