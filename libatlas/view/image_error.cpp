#include "libatlas/view/image_error.h"

#include <cassert>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

namespace atlas {
namespace {

// Sums of values, squares and products of two images, over one window or one column of a window.
struct Sums {
  double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  void add(double x, double y, double sign) {
    a += sign * x;
    b += sign * y;
    aa += sign * x * x;
    bb += sign * y * y;
    ab += sign * x * y;
  }
};

double similarity(const Sums& s, double n) {
  constexpr double c1 = 0.01 * 0.01 * 255 * 255, c2 = 0.03 * 0.03 * 255 * 255;
  const double ma = s.a / n, mb = s.b / n;
  const double va = s.aa / n - ma * ma, vb = s.bb / n - mb * mb, cab = s.ab / n - ma * mb;
  return (2 * ma * mb + c1) * (2 * cab + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
}

}  // namespace

double psnr(const Image8& a, const Image8& b) {
  assert(a.width == b.width && a.height == b.height && a.channels == b.channels);
  double sum = 0;
  for (std::size_t i = 0; i < a.texels.size(); ++i) {
    const double d = double(a.texels[i]) - b.texels[i];
    sum += d * d;
  }
  if (sum == 0) return std::numeric_limits<double>::infinity();
  return 10 * std::log10(255.0 * 255.0 * double(a.texels.size()) / sum);
}

double ssim(const Image8& a, const Image8& b) {
  assert(a.width == b.width && a.height == b.height);
  constexpr int kWindow = 8;
  if (a.width < kWindow || a.height < kWindow) return a.texels == b.texels ? 1 : 0;
  std::vector<Sums> columns(std::size_t(a.width));
  double total = 0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      columns[std::size_t(x)].add(*a.at(x, y), *b.at(x, y), 1);
      if (y >= kWindow)
        columns[std::size_t(x)].add(*a.at(x, y - kWindow), *b.at(x, y - kWindow), -1);
    }
    if (y < kWindow - 1) continue;
    for (int x = 0; x + kWindow <= a.width; ++x) {
      Sums s;
      for (int i = 0; i < kWindow; ++i) {
        const Sums& c = columns[std::size_t(x + i)];
        s.a += c.a, s.b += c.b, s.aa += c.aa, s.bb += c.bb, s.ab += c.ab;
      }
      total += similarity(s, kWindow * kWindow);
    }
  }
  return total / (double(a.width - kWindow + 1) * (a.height - kWindow + 1));
}

VisibilityError visibility_error(const Image8& got, const Image8& truth) {
  assert(got.width == truth.width && got.height == truth.height);
  VisibilityError e;
  const std::size_t pixels = std::size_t(truth.width) * truth.height;
  for (std::size_t i = 0; i < pixels; ++i) {
    const int t = truth.texels[i * truth.channels], g = got.texels[i * got.channels];
    const int d = std::abs(t - g);
    const bool edge = t > 0 && t < 255;
    e.mean += d;
    e.wrong += d > 127;
    e.edge_share += edge;
    if (!edge) {
      e.mean_off_edges += d;
      e.wrong_off_edges += d > 127;
    }
  }
  const double n = double(pixels);
  return {e.mean / n / 255, e.wrong / n, e.mean_off_edges / n / 255, e.wrong_off_edges / n,
          e.edge_share / n};
}

}  // namespace atlas
