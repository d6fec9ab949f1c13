#include "libatlas/bake/least_squares.h"

#include <algorithm>

namespace atlas {
namespace {

// A texel's own matrix element is about 4/9 where it is sampled all round. Below this it counts as
// untouched; what it would hold no look-up could tell.
constexpr float kTouched = 1e-7f;

// Weight of the difference between neighbours: a thousandth of what samples weigh. A hundred times
// more starts to blur; a hundred times less leaves border texels to rounding.
constexpr float kSmoothness = 1e-3f;

// Symmetric Gauss-Seidel halves the error or better with each sweep (the scaled bilinear mass
// matrix has a condition number of 9); past these the change is below half an 8-bit step.
constexpr int kSweeps = 6;

Lanes clamped(Lanes v, float low, float high) {
  for (int k = 0; k < 3; ++k) v[k] = std::clamp(v[k], low, high);
  return v;
}

}  // namespace

// The mean of the samples around each texel, weighted by its tent: the matrix lumped to its
// diagonal.
void LeastSquares::start(TexelGrid& out) const {
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const std::size_t at = std::size_t(y) * width_ + x;
      const Cell& c = cells_[at];
      const float self = c.value[3];
      if (!(self > kTouched)) continue;
      const Cell* w = x > 0 ? &c - 1 : nullptr;
      const Cell* e = x + 1 < width_ ? &c + 1 : nullptr;
      const Cell* s = y > 0 ? &c - width_ : nullptr;
      float row = self + c.pair[0] + c.pair[1] + c.pair[2] + c.pair[3];
      if (w) row += w->pair[0];
      if (s) row += s->pair[1];
      if (s && w) row += (s - 1)->pair[2];
      if (s && e) row += (s + 1)->pair[3];
      out.rgb[at] = c.value / row;
      out.known[at] = 1;
    }
}

void LeastSquares::sweep(bool forward, float low, float high, TexelGrid& out) const {
  const auto index = [&](int x, int y) { return std::size_t(y) * width_ + x; };
  for (int row = 0; row < height_; ++row) {
    const int y = forward ? row : height_ - 1 - row;
    for (int column = 0; column < width_; ++column) {
      const int x = forward ? column : width_ - 1 - column;
      const std::size_t at = index(x, y);
      if (!out.known[at]) continue;
      const Cell& c = cells_[at];
      Lanes sum = c.value;
      float diagonal = c.value[3];
      const bool west = x > 0, east = x + 1 < width_, south = y > 0, north = y + 1 < height_;
      const auto couple = [&](std::size_t other, float a, float smooth) {
        if (!out.known[other]) return;
        sum += (smooth - a) * out.rgb[other];
        diagonal += smooth;
      };
      if (east) couple(at + 1, c.pair[0], kSmoothness);
      if (west) couple(at - 1, cells_[at - 1].pair[0], kSmoothness);
      if (north) {
        couple(at + width_, c.pair[1], kSmoothness);
        if (east) couple(at + width_ + 1, c.pair[2], 0);
        if (west) couple(at + width_ - 1, c.pair[3], 0);
      }
      if (south) {
        couple(at - width_, cells_[at - width_].pair[1], kSmoothness);
        if (west) couple(at - width_ - 1, cells_[at - width_ - 1].pair[2], 0);
        if (east) couple(at - width_ + 1, cells_[at - width_ + 1].pair[3], 0);
      }
      out.rgb[at] = clamped(sum / diagonal, low, high);
    }
  }
}

void LeastSquares::solve(float low, float high, TexelGrid& out) const {
  start(out);
  for (int i = 0; i < kSweeps; ++i) sweep(i % 2 == 0, low, high, out);
}

}  // namespace atlas
