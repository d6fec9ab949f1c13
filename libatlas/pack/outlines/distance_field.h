// Internal: the signed distance to a chart's outline, sampled on a grid.
#pragma once

#include <vector>

#include "libatlas/pack/outlines/outline_mask.h"

namespace atlas::pack {

// The coordinates are those of the mask from which the field is made: texels from the lower left
// corner of the mask's box. The distance is negative inside the chart. A mask exceeds its chart by
// up to one cell on each side; the mean of this, half a cell, is subtracted.
class DistanceField {
 public:
  DistanceField() = default;
  DistanceField(const Mask& mask, double cell, double reach);

  struct Sample {
    double distance = 0;
    Vec2d gradient;  // not normalised
  };
  // Returns false if p is farther than `reach` outside the mask's box.
  bool sample(Vec2d p, Sample& out) const {
    const double gx = p.x * inverse_ + shift_, gy = p.y * inverse_ + shift_;
    if (!(gx >= 0) || !(gy >= 0) || gx >= width_ - 1 || gy >= height_ - 1) return false;
    const int x = static_cast<int>(gx), y = static_cast<int>(gy);
    const double u = gx - x, v = gy - y;
    const float* a = values_.data() + std::size_t(y) * std::size_t(width_) + std::size_t(x);
    const float* b = a + width_;
    const double low = a[0] + u * (a[1] - a[0]), high = b[0] + u * (b[1] - b[0]);
    out.distance = low + v * (high - low);
    out.gradient = {(1 - v) * (a[1] - a[0]) + v * (b[1] - b[0]), high - low};
    return true;
  }

  // Returns whether sample() may be true for a point within `radius` of p.
  bool near_grid(Vec2d p, double radius) const {
    const double gx = p.x * inverse_ + shift_, gy = p.y * inverse_ + shift_, r = radius * inverse_;
    return gx > -r && gy > -r && gx < width_ - 1 + r && gy < height_ - 1 + r;
  }

  // Returns points on the outline, about one per `spacing` texels.
  std::vector<Vec2d> outline(double spacing) const;

 private:
  Vec2d onto_outline(Vec2d p) const;

  int width_ = 0, height_ = 0;
  double inverse_ = 1, shift_ = 0;
  std::vector<float> values_;  // values at the cells' centres, row by row
};

}  // namespace atlas::pack
