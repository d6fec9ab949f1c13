#include "libatlas/pack/fitting/lost_room.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/layout_checks.h"

namespace atlas {
namespace {

struct Quad {
  Vec2d a, b, c, d;
};

void add_quad(const Quad& q, std::vector<Vec2d>& corners) {
  corners.insert(corners.end(), {q.a, q.b, q.c, q.a, q.c, q.d});
}

std::vector<Vec2d> rectangle(double width, double height) {
  std::vector<Vec2d> corners;
  add_quad({{0, 0}, {width, 0}, {width, height}, {0, height}}, corners);
  return corners;
}

// Returns the lost area of charts on one page of 256 texels, with a padding of one texel.
double lost_area(std::vector<std::vector<Vec2d>> shapes) {
  const test::ChartItems charts(std::move(shapes));
  FitOptions o;
  o.page_size = 256;
  o.padding = o.alignment = 1;
  o.minimum_side = 0;
  o.shapes = charts.shapes;
  const Result<FitResult> r = fit_pages(charts.items, o, {});
  EXPECT_TRUE(r.ok()) << r.status().message();
  return r.ok() ? r->lost_area : -1;
}

// Returns a square of n x n cells, each with a square hole of side `hole` (three corners per
// triangle).
std::vector<Vec2d> perforated(int n, double cell, double hole) {
  std::vector<Vec2d> corners;
  const double in = (cell - hole) / 2;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double x0 = i * cell, y0 = j * cell, x1 = (i + 1) * cell, y1 = (j + 1) * cell;
      const Vec2d a{x0, y0}, b{x1, y0}, c{x1, y1}, d{x0, y1};
      const Vec2d e{x0 + in, y0 + in}, f{x0 + in + hole, y0 + in};
      const Vec2d g{x0 + in + hole, y0 + in + hole}, h{x0 + in, y0 + in + hole};
      for (const Quad& q : {Quad{a, b, f, e}, {b, c, g, f}, {c, d, h, g}, {d, a, e, h}})
        add_quad(q, corners);
    }
  return corners;
}

// Holes that are too small for cuts to open count as lost, less the area of other charts that fit
// into them.
TEST(LostRoom, SmallHoles) {
  EXPECT_NEAR(lost_area({perforated(8, 10, 6)}), 64 * 36, 1e-9);
  EXPECT_NEAR(lost_area({perforated(8, 10, 6), rectangle(7, 7)}), 64 * 36, 1e-9);
  EXPECT_NEAR(lost_area({perforated(8, 10, 6), rectangle(5, 5)}), 64 * 36 - 25, 1e-9);
  EXPECT_EQ(lost_area({perforated(1, 80, 48)}), 0);
  EXPECT_EQ(lost_area({rectangle(20, 20)}), 0);
}

struct Comb {
  int teeth;
  double tooth, gap, length, spine;
};

std::vector<Vec2d> teeth_of(const Comb& comb) {
  std::vector<Vec2d> corners;
  const double top = comb.spine + comb.length;
  for (int k = 0; k < comb.teeth; ++k) {
    const double left = k * (comb.tooth + comb.gap), right = left + comb.tooth;
    add_quad({{left, 0}, {right, 0}, {right, comb.spine}, {left, comb.spine}}, corners);
    add_quad({{left, comb.spine}, {right, comb.spine}, {right, top}, {left, top}}, corners);
    if (k + 1 == comb.teeth) break;
    const double next = left + comb.tooth + comb.gap;
    add_quad({{right, 0}, {next, 0}, {next, comb.spine}, {right, comb.spine}}, corners);
  }
  return corners;
}

// Gaps between teeth that are narrower than gutters count as lost, less the area of other charts
// that fit into them.
TEST(LostRoom, NarrowBays) {
  const std::vector<Vec2d> narrow = teeth_of({40, 3, 3, 180, 30});
  const double gaps = 39 * 3 * 180, near = 0.03 * gaps;
  EXPECT_NEAR(lost_area({narrow}), gaps, near);
  EXPECT_NEAR(lost_area({narrow, narrow}), 2 * gaps, 2 * near);
  EXPECT_NEAR(lost_area({narrow, rectangle(27, 27)}), gaps, near);
  EXPECT_NEAR(lost_area({narrow, rectangle(200, 3)}), gaps - 600, near);
  EXPECT_EQ(lost_area({teeth_of({10, 9, 15, 180, 30})}), 0);
  EXPECT_EQ(lost_area({rectangle(500, 1)}), 0);
}

// A strip that is wound in a spiral, with radii from turns / (2 pi) to that plus kStrip. Also
// computes the morphological closing of its points by a square, comparing each point with all
// around it.
class Spiral {
 public:
  static constexpr double kStrip = 0.3, kFirst = 2, kLast = 9;

  std::vector<Vec2d> strip() const {
    constexpr int kSteps = 600;
    std::vector<Vec2d> corners;
    for (int k = 0; k < kSteps; ++k) {
      const double from = angle_of(double(k) / kSteps), to = angle_of(double(k + 1) / kSteps);
      add_quad({at(from, 0), at(from, kStrip), at(to, kStrip), at(to, 0)}, corners);
    }
    return corners;
  }

  double closed_bays(double width) const {
    constexpr int kHalf = 8, kSide = 2 * kHalf + 1;
    const double cell = width / kSide;
    const int n = int(2 * (kLast + 1 + width) / cell);
    std::vector<char> chart(std::size_t(n) * std::size_t(n)), near = chart;
    const auto in = [&](const std::vector<char>& cells, int x, int y) {
      return x >= 0 && y >= 0 && x < n && y < n &&
             cells[std::size_t(y) * std::size_t(n) + std::size_t(x)];
    };
    const auto each = [&](auto visit) {
      for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) visit(x, y, std::size_t(y) * std::size_t(n) + std::size_t(x));
    };
    // Counts the cells of a square around each, first along rows and then along columns.
    std::vector<int> in_row(chart.size()), around(chart.size());
    const auto count_around = [&](const std::vector<char>& cells) {
      each([&](int x, int y, std::size_t k) {
        in_row[k] = 0;
        for (int dx = -kHalf; dx <= kHalf; ++dx) in_row[k] += in(cells, x + dx, y);
      });
      each([&](int, int y, std::size_t k) {
        around[k] = 0;
        for (int dy = std::max(-kHalf, -y); dy <= std::min(kHalf, n - 1 - y); ++dy)
          around[k] += in_row[std::size_t(std::ptrdiff_t(k) + std::ptrdiff_t(dy) * n)];
      });
    };
    const auto coordinate = [&](int k) { return (k + 0.5 - n / 2.0) * cell; };
    each([&](int x, int y, std::size_t k) { chart[k] = holds({coordinate(x), coordinate(y)}); });
    count_around(chart);
    each([&](int, int, std::size_t k) { near[k] = around[k] > 0; });
    count_around(near);
    int bays = 0;
    each([&](int, int, std::size_t k) {
      bays += !chart[k] && near[k] && around[k] == kSide * kSide;
    });
    return bays * cell * cell;
  }

 private:
  static double angle_of(double share) {
    return 2 * std::numbers::pi * (kFirst + share * (kLast - kFirst));
  }
  static Vec2d at(double angle, double out) {
    const double r = angle / (2 * std::numbers::pi) + out;
    return {r * std::cos(angle), r * std::sin(angle)};
  }
  static bool holds(Vec2d p) {
    double turn = std::atan2(p.y, p.x) / (2 * std::numbers::pi);
    for (turn -= 1; turn <= kLast; ++turn) {
      const double out = std::hypot(p.x, p.y) - turn;
      if (turn >= kFirst && out >= 0 && out <= kStrip) return true;
    }
    return false;
  }
};

TEST(LostRoom, BaysAreThoseOfAClosing) {
  const Spiral spiral;
  const std::vector<Vec2d> strip = spiral.strip();
  const std::vector outlines{pack::outline_of({strip, {}})};
  // The function uses cells of an eighth of the width, so a bay may be wider by one cell.
  for (const double width : {0.35, 0.55, 0.65, 0.8, 1.2}) {
    const double bays = pack::lost_to_bays(outlines, width / 4, {});
    EXPECT_GE(bays, 0.95 * spiral.closed_bays(width) - 1) << width;
    EXPECT_LE(bays, spiral.closed_bays(1.19 * width) + 1) << width;
  }
}

}  // namespace
}  // namespace atlas
