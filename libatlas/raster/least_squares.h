// Internal: LeastSquares, which finds the texels whose bilinear interpolation fits weighted samples
// best.
#pragma once

#include <cstddef>
#include <vector>

#include "libatlas/raster/texel_grid.h"

namespace atlas {

// Minimises sum_i w_i |bilinear(texels, x_i) - c_i|² plus a small multiple of the squared
// differences between neighbouring texels, which determines the texels that hardly any sample
// reads. The matrix of the normal equations couples a texel with its eight neighbours. It is
// symmetric, so only four of the eight elements are stored. They are accumulated sample by sample.
class LeastSquares {
  struct alignas(32) Cell {
    Lanes value{};  // right-hand side of R, G, B; diagonal element
    Lanes pair{};   // elements with the east, north, north-east and north-west neighbours
  };

 public:
  LeastSquares(int width, int height)
      : width_(width), height_(height), stride_(width + 2), cells_(stride_ * (height + 2)) {}

  int width() const { return width_; }
  int height() const { return height_; }

  // The bilinear weights of a sample for the four texels around it, already multiplied by its own
  // weight.
  class Splat {
   public:
    // (tx, ty) is the position between the centres of texels (0, 0) and (1, 1), in [0, 1].
    Splat(float tx, float ty, float weight) {
      const float w[4] = {(1 - tx) * (1 - ty), tx * (1 - ty), (1 - tx) * ty, tx * ty};
      for (int k = 0; k < 4; ++k) {
        const float s = weight * w[k];
        share_[k].value = Lanes{s, s, s, s * w[k]};
      }
      share_[0].pair = weight * Lanes{w[0] * w[1], w[0] * w[2], w[0] * w[3], 0};
      share_[1].pair = weight * Lanes{0, w[1] * w[3], 0, w[1] * w[2]};
      share_[2].pair = weight * Lanes{w[2] * w[3], 0, 0, 0};
    }

   private:
    friend class LeastSquares;
    Cell share_[4];  // one per texel; `value` is still to be multiplied by the colour
  };

  // Adds a sample whose lower left texel is (x, y). rgb1 is its colour, with a 1 in the 4th lane.
  void add(int x, int y, const Splat& s, Lanes rgb1) {
    Cell* c = &cells_[index(x, y)];
    Cell* d = c + stride_;
    c[0].value += s.share_[0].value * rgb1;
    c[0].pair += s.share_[0].pair;
    c[1].value += s.share_[1].value * rgb1;
    c[1].pair += s.share_[1].pair;
    d[0].value += s.share_[2].value * rgb1;
    d[0].pair += s.share_[2].pair;
    d[1].value += s.share_[3].value * rgb1;
  }

  // The lower left texel of the first sample of a row of samples. They are one texel apart, and the
  // splat applies to each of them.
  struct Run {
    int x, y;
    const Splat& splat;
  };

  // Adds n samples of a row. Each cell is then read and written only once, for the two samples
  // beside it.
  void add_row(const Run& run, const Lanes* rgb1, int n);

  // Returns the solution, clamped to [low, high]. A texel is known if a sample has touched it. May
  // be called only once, because it overwrites the sums, and frees them before it copies the
  // result.
  TexelGrid solve(float low, float high) &&;

 private:
  // The grid has a border of cells that no sample touches, so that loops need no tests at its
  // sides.
  std::size_t index(int x, int y) const { return (y + 1) * stride_ + x + 1; }

  struct Kernels;  // the inner loops, with and without wide vectors

  struct Bounds {
    float low, high;
  };
  struct Solution {
    std::vector<Lanes> x;              // with the border
    std::vector<unsigned char> known;  // without
  };

  void drop_untouched();
  void start_row(int j, Solution& to) const;
  void smooth_row(int j);
  void sweep_row(int j, const Bounds& bounds, Solution& to) const;
  TexelGrid without_border(Solution&& from) const;

  int width_, height_;
  std::size_t stride_;
  std::vector<Cell> cells_;
};

}  // namespace atlas
