#include "libatlas/pack/outlines/distance_field.h"

#include <algorithm>
#include <cmath>

#include "libatlas/core/portable_math.h"

namespace atlas::pack {
namespace {

// Computes the exact squared distances, in cells, from each cell to the nearest cell of the other
// kind: first within the columns, and then along the rows as lower envelopes of parabolas
// (Felzenszwalb and Huttenlocher 2012). Each run of equal cells in a row has an envelope of its
// own. Cells beyond the two that end the run need not be examined, because the run's cells are
// nearer to these two.
class SquaredDistances {
 public:
  SquaredDistances(int width, const std::vector<std::uint8_t>& kind, std::vector<float>& grid)
      : width_(std::size_t(width)), kind_(kind), grid_(grid) {
    line_.resize(width_ + 2);
    apex_.resize(width_ + 2);
    border_.resize(width_ + 3);
    columns();
    for (std::size_t row = 0; row < grid_.size(); row += width_)
      for (std::size_t x = 0; x < width_;) {
        const std::size_t begin = x;
        while (x < width_ && kind_[row + x] == kind_[row + begin]) ++x;
        transform(row, begin, x);
      }
  }

 private:
  static constexpr float kFar = 1e6f;

  // Counts the rows to the nearest cell of the other kind, first below, then above.
  void columns() {
    std::fill(grid_.begin(), grid_.begin() + std::ptrdiff_t(width_), kFar);
    for (std::size_t i = width_; i < grid_.size(); ++i)
      grid_[i] = kind_[i] == kind_[i - width_] ? grid_[i - width_] + 1 : 1;
    for (std::size_t i = grid_.size() - width_; i-- > 0;)
      grid_[i] = kind_[i] == kind_[i + width_] ? std::min(grid_[i], grid_[i + width_] + 1) : 1;
  }

  // Processes the columns [begin, end) of a row, which are of one kind.
  void transform(std::size_t row, std::size_t begin, std::size_t end) {
    // line_[0] is the cell before the run, if the row has one.
    const int count = int(end - begin);
    line_[0] = begin > 0 ? 0.f : kFar * kFar;
    for (int q = 1; q <= count; ++q) {
      const float rows = grid_[row + begin + std::size_t(q) - 1];
      line_[std::size_t(q)] = rows * rows;
    }
    line_[std::size_t(count) + 1] = end < width_ ? 0.f : kFar * kFar;
    int k = -1;
    for (int q = 0; q <= count + 1; ++q) {
      const float f = line_[std::size_t(q)];
      if (f >= kFar * kFar) continue;
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
    k = 0;
    for (int q = 1; q <= count; ++q) {
      while (k < last && border_[std::size_t(k) + 1] < float(q)) ++k;
      const int p = apex_[std::size_t(k)];
      grid_[row + begin + std::size_t(q) - 1] =
          last < 0 ? kFar * kFar : float((q - p) * (q - p)) + line_[std::size_t(p)];
    }
  }

  std::size_t width_;
  const std::vector<std::uint8_t>& kind_;  // one per cell
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
  std::vector<std::uint8_t> inside(count);
  for (std::int32_t r = 0; r < mask.height; ++r)
    for (const Run& run : mask.row(r)) {
      const std::size_t row = std::size_t(r + margin) * std::size_t(width_) + std::size_t(margin);
      std::fill(inside.begin() + std::ptrdiff_t(row + std::size_t(run.begin)),
                inside.begin() + std::ptrdiff_t(row + std::size_t(run.end)), std::uint8_t{1});
    }
  values_.resize(count);
  SquaredDistances(width_, inside, values_);
  for (std::size_t i = 0; i < count; ++i) {
    // The distances are from centre to centre. The mask's edge lies half a cell nearer, and the
    // chart's outline is assumed another half cell inside the mask.
    const double d = inside[i] ? 1.0 - std::sqrt(double(values_[i])) : std::sqrt(values_[i]);
    values_[i] = static_cast<float>(d * cell);
  }
}

// Moves p one step along the gradient.
Vec2d DistanceField::onto_outline(Vec2d p) const {
  Sample s, ahead;
  // Half a cell: from a cell's centre this gives the mean of both sides.
  const double h = 0.5 / inverse_;
  if (!sample({p.x - h, p.y - h}, s) || !sample({p.x + h, p.y + h}, ahead)) return p;
  const Vec2d g{s.gradient.x + ahead.gradient.x, s.gradient.y + ahead.gradient.y};
  const double length = portable::hypot(g.x, g.y);
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
