#include "libatlas/pack/outline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libatlas/pack/nesting/bit_page.h"
#include "tests/support/layout_checks.h"

namespace atlas {
namespace {

std::vector<std::vector<Vec2d>> blobs(int count, double radius, std::uint64_t seed) {
  test::Noise noise{seed};
  std::vector<std::vector<Vec2d>> shapes;
  for (int k = 0; k < count; ++k) {
    const int corners = noise.in(3, 12);
    const double size = radius * (0.3 + noise.unit());
    shapes.push_back(test::blob(noise, size, corners));
  }
  return shapes;
}

std::vector<ChartShape> views(const std::vector<std::vector<Vec2d>>& shapes) {
  std::vector<ChartShape> v;
  for (const auto& s : shapes) v.push_back({s, {}});
  return v;
}

std::vector<test::PlacedShape> placed(const std::vector<ChartShape>& shapes, double scale,
                                      const OutlineResult& r) {
  std::vector<test::PlacedShape> out;
  for (std::size_t i = 0; i < shapes.size(); ++i)
    if (const OutlinePlacement& p = r.placements[i]; p.page != kNoPage)
      out.push_back({shapes[i], p.page, scale, p.angle, p.offset});
  return out;
}

TEST(Outline, ChartsKeepTheirGutters) {
  for (std::uint32_t rotations : {1u, 2u, 4u, 8u, 16u})
    for (int padding : {0, 1, 2})
      for (int alignment : {1, 4}) {
        const auto shapes = blobs(40, 25, rotations * 100 + unsigned(padding));
        const auto v = views(shapes);
        OutlineOptions o;
        o.page = {256, 0};
        o.rotations = rotations;
        o.padding = padding;
        o.alignment = alignment;
        o.preset = PackPreset::fast;
        const Result<OutlineResult> r = pack_outlines(v, o, {});
        ASSERT_TRUE(r.ok()) << r.status().message();
        EXPECT_TRUE(r->unplaced.empty());
        if (padding > 0) {
          EXPECT_EQ(test::check_outlines(placed(v, 1, *r), r->pages, padding), "")
              << rotations << " " << padding << " " << alignment;
        }
        double area = 0;
        for (std::size_t i = 0; i < v.size(); ++i) {
          const Rect& box = r->placements[i].box;
          EXPECT_EQ(box.x % alignment, 0);
          EXPECT_EQ(box.width % alignment, 0);
          for (std::size_t k = 0; k < shapes[i].size(); k += 3) {
            const Vec2d* p = &shapes[i][k];
            area += std::abs((p[1].x - p[0].x) * (p[2].y - p[0].y) -
                             (p[1].y - p[0].y) * (p[2].x - p[0].x)) /
                    2;
          }
        }
        EXPECT_NEAR(r->utilization, area / double(r->pages[0].area()), 1e-9);
      }
}

TEST(Outline, CoveredAreaCountsWhatLiesOnItselfOnce) {
  const std::vector<Vec2d> corners{{0, 0}, {8, 0}, {8, 8}, {0, 8}};
  const std::vector<std::uint32_t> twice{0, 1, 2, 0, 2, 3, 0, 1, 2}, beyond{0, 1, 4};
  const Result<double> area = covered_area(std::vector<ChartShape>{{corners, twice}}, {});
  ASSERT_TRUE(area.ok());
  EXPECT_NEAR(*area, 64, 1);
  EXPECT_EQ(covered_area(std::vector<ChartShape>{{corners, beyond}}, {}).status().code(),
            ErrorCode::bad_input);
}

// The limits of shapes.h: corners are finite, below 1e9, and three a triangle.
TEST(Outline, ShapesThatAreNoneAreRefusedByName) {
  using Shape = std::vector<Vec2d>;
  const Shape sound{{0, 0}, {5, 0}, {0, 5}};
  const auto expect = [&](const Shape& shape, ErrorCode code) {
    const std::vector<ChartShape> shapes{{sound, {}}, {shape, {}}};
    const Status status = covered_area(shapes, {}).status();
    EXPECT_EQ(status.code(), code) << status.message();
    EXPECT_EQ(pack_outlines(shapes, {}, {}).status().code(), code);
    if (code != ErrorCode::ok) {
      EXPECT_NE(status.message().find("shape 1 "), std::string::npos) << status.message();
    }
  };
  const double below = std::nextafter(1e9, 0);
  expect({{below, -below}, {below, 1 - below}, {below - 1, -below}}, ErrorCode::ok);
  for (const double bad : {1e9, -1e9, double(NAN), double(INFINITY)}) {
    expect({{0, 0}, {bad, 0}, {0, 1}}, ErrorCode::bad_input);
    expect({{0, 0}, {1, 0}, {0, bad}}, ErrorCode::bad_input);
  }
  for (const std::size_t corners : {1, 2, 4, 5})
    expect(Shape(corners, {1, 1}), ErrorCode::bad_input);
  const std::vector<std::uint32_t> two{0, 1};
  const std::vector<ChartShape> odd{{sound, {}}, {sound, two}};
  EXPECT_EQ(covered_area(odd, {}).status().code(), ErrorCode::bad_input);
}

TEST(Outline, RectanglesAreASpecialCase) {
  // Sixteen squares of 30 texels with one texel around each exactly fill a page of 128.
  const std::vector<Vec2d> square{{0, 0}, {30, 0}, {30, 30}, {0, 0}, {30, 30}, {0, 30}};
  const std::vector<ChartShape> shapes(16, ChartShape{square, {}});
  OutlineOptions o;
  o.page = {128, 128};
  const Result<OutlineResult> r = pack_outlines(shapes, o, {});
  ASSERT_TRUE(r.ok());
  EXPECT_TRUE(r->unplaced.empty());
  EXPECT_NEAR(r->utilization, 16.0 * 900 / (128 * 128), 1e-12);
}

TEST(Outline, SearchAndPagesAndThreads) {
  const auto shapes = blobs(60, 30, 5);
  const auto v = views(shapes);
  OutlineOptions o;
  o.page = {160, 160};
  o.max_pages = 0;
  const Result<OutlineResult> pages = pack_outlines(v, o, {});
  ASSERT_TRUE(pages.ok());
  EXPECT_GT(pages->pages.size(), 1u);
  EXPECT_TRUE(pages->unplaced.empty());
  EXPECT_EQ(test::check_outlines(placed(v, 1, *pages), pages->pages, 1), "");
  o.page = {256, 0};
  o.max_pages = 1;
  o.preset = PackPreset::fast;
  const Result<OutlineResult> fast = pack_outlines(v, o, {});
  o.preset = PackPreset::best;
  o.effort = 40;
  o.time_budget = 1e9;
  Context one;
  one.threads = 1;
  const Result<OutlineResult> best = pack_outlines(v, o, one);
  const Result<OutlineResult> again = pack_outlines(v, o, {});
  ASSERT_TRUE(fast.ok() && best.ok() && again.ok());
  EXPECT_GE(best->utilization, fast->utilization);
  EXPECT_EQ(best->pages, again->pages);
  for (std::size_t i = 0; i < v.size(); ++i)
    EXPECT_EQ(best->placements[i].box, again->placements[i].box);
  EXPECT_EQ(test::check_outlines(placed(v, 1, *best), best->pages, 1), "");
}

TEST(Outline, HostileShapes) {
  const std::vector<Vec2d> point(3, Vec2d{5, 5}), line{{0, 0}, {20, 7}, {10, 3.5}}, none;
  const std::vector<Vec2d> huge{{0, 0}, {1e6, 0}, {0, 1e6}};
  const std::vector<ChartShape> shapes{{point, {}}, {line, {}}, {none, {}}, {huge, {}}};
  OutlineOptions o;
  o.page = {64, 64};
  const Result<OutlineResult> r = pack_outlines(shapes, o, {});
  ASSERT_TRUE(r.ok());
  EXPECT_EQ(r->unplaced, std::vector<std::uint32_t>{3});
  EXPECT_EQ(r->placements[2].page, 0u);
  const std::vector<Vec2d> bad{{0, 0}, {NAN, 0}, {0, 1}};
  const std::vector<ChartShape> with_nan{{bad, {}}};
  EXPECT_EQ(pack_outlines(with_nan, o, {}).status().code(), ErrorCode::bad_input);
  const std::vector<std::uint32_t> wild{0, 1, 7};
  const std::vector<ChartShape> out_of_range{{line, wild}};
  EXPECT_EQ(pack_outlines(out_of_range, o, {}).status().code(), ErrorCode::bad_input);
  o.rotations = 3;
  EXPECT_EQ(pack_outlines(shapes, o, {}).status().code(), ErrorCode::bad_option);
}

using pack::BitPage;
using pack::Mask;
using pack::Run;

bool covers(const Mask& m, int x, int y) {
  if (x < 0 || y < 0 || x >= m.width || y >= m.height) return false;
  for (const Run& r : m.row(y))
    if (x >= r.begin && x < r.end) return true;
  return false;
}

// Returns the largest separation of triangle and rectangle over their axes. It is negative if they
// overlap.
double separation(const Vec2d* t, Vec2d low, Vec2d high) {
  double gap = -1e300;
  const auto axis = [&](double ax, double ay) {
    double lo = 1e300, hi = -1e300, slo = 1e300, shi = -1e300;
    for (int k = 0; k < 3; ++k) {
      lo = std::min(lo, ax * t[k].x + ay * t[k].y);
      hi = std::max(hi, ax * t[k].x + ay * t[k].y);
    }
    for (double sx : {low.x, high.x})
      for (double sy : {low.y, high.y}) {
        slo = std::min(slo, ax * sx + ay * sy);
        shi = std::max(shi, ax * sx + ay * sy);
      }
    gap = std::max(gap, std::max(slo - hi, lo - shi));
  };
  axis(1, 0);
  axis(0, 1);
  for (int k = 0; k < 3; ++k) {
    const Vec2d a = t[k], b = t[(k + 1) % 3];
    if (a == b) continue;
    axis(b.y - a.y, a.x - b.x);
  }
  return gap;
}

// Returns triangles of three corners each: single ones, soups with both orientations, and fans. The
// grid of their corners is so coarse that many coincide, lie on a line or share edges.
std::vector<Vec2d> soup(test::Noise& noise, int round) {
  const auto point = [&] {
    return Vec2d{double(noise.in(0, 40)) / 4, double(noise.in(0, 40)) / 4};
  };
  std::vector<Vec2d> t;
  if (round % 3 == 2) {
    t = test::blob(noise, 8, noise.in(3, 9));
    if (noise.in(0, 1)) std::swap(t[1], t[2]);
    return t;
  }
  std::vector<Vec2d> corners;
  for (int k = 0; k < 6; ++k) corners.push_back(point());
  for (int n = round % 3 == 0 ? 1 : noise.in(2, 9); n > 0; --n)
    for (int k = 0; k < 3; ++k) t.push_back(corners[std::size_t(noise.in(0, 5))]);
  return t;
}

// Compares the rasteriser with a separating-axis test of square and triangle, cell by cell.
void expect_exact_mask(std::vector<Vec2d> t, const pack::RasterOptions& o, int round) {
  Vec2d origin;
  const Mask m = pack::rasterize(pack::outline_of({t, {}}), o, origin);
  for (Vec2d& p : t) p = {p.x + origin.x, p.y + origin.y};
  for (int y = -1; y <= m.height; ++y)
    for (int x = -1; x <= m.width; ++x) {
      const Vec2d low{double(x * o.cell - o.padding), double(y * o.cell - o.padding)};
      const Vec2d high{double((x + 1) * o.cell + o.padding), double((y + 1) * o.cell + o.padding)};
      double gap = 1e300;
      for (std::size_t k = 0; k < t.size(); k += 3)
        gap = std::min(gap, separation(&t[k], low, high));
      if (std::abs(gap) > 1e-9) {
        EXPECT_EQ(covers(m, x, y), gap < 0) << round << " " << x << " " << y;
      }
    }
}

TEST(OutlineMask, MatchesSeparatingAxes) {
  test::Noise noise{3};
  for (int round = 0; round < 900; ++round) {
    const std::vector<Vec2d> t = soup(noise, round);
    pack::RasterOptions o;
    o.padding = noise.in(0, 2);
    o.cell = noise.in(1, 3);
    expect_exact_mask(t, o, round);
  }
}

// Several edges pass through one column of cells and rise or fall by different heights: a comb of
// slanted teeth whose corners lie on lines between cells, on centres of cells or anywhere.
TEST(OutlineMask, FineTeethMatchSeparatingAxes) {
  test::Noise noise{8};
  for (int round = 0; round < 90; ++round) {
    const double grid = std::array{8.0, 16.0, 1000.0}[std::size_t(round) % 3];
    const auto snapped = [&](double v) { return std::round(v * grid) / grid; };
    const int teeth = noise.in(8, 40);
    std::vector<Vec2d> t;
    for (int k = 0; k < teeth; ++k) {
      const double left = snapped(6.0 * k / teeth), right = snapped(6.0 * (k + 1) / teeth);
      const Vec2d tip{snapped(left + noise.unit()), snapped(1 + 7 * noise.unit())};
      t.insert(t.end(), {{left, 0}, {right, 0}, {right, 1}, {left, 0}, {right, 1}, {left, 1}});
      t.insert(t.end(), {{left, 1}, {right, 1}, tip});
    }
    pack::RasterOptions o;
    o.padding = noise.in(0, 2);
    o.cell = noise.in(1, 3);
    expect_exact_mask(t, o, round);
  }
}

// There are more row crossings than the rasteriser sorts: bars of 4 cells with one free cell
// between.
TEST(OutlineMask, BarsWithoutNumberStayApart) {
  constexpr int kBars = 3000, kHeight = 700;
  std::vector<Vec2d> t;
  for (int k = 0; k < kBars; ++k) {
    const double left = 5 * k + (k > 0 ? 0.25 : 0), right = 5 * k + 3.5, top = kHeight - 0.5;
    for (const Vec2d& p : {Vec2d{left, 0}, Vec2d{right, 0}, Vec2d{right, top}, Vec2d{left, 0},
                           Vec2d{right, top}, Vec2d{left, top}})
      t.push_back(p);
  }
  pack::RasterOptions o;
  o.padding = 0;
  Vec2d origin;
  const Mask m = pack::rasterize(pack::outline_of({t, {}}), o, origin);
  ASSERT_EQ(m.width, 5 * kBars - 1);
  ASSERT_EQ(m.height, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    ASSERT_EQ(m.row(y).size(), std::size_t{kBars});
    for (int k = 0; k < kBars; ++k) ASSERT_EQ(m.row(y)[k], (pack::Run{5 * k, 5 * k + 4})) << y;
  }
}

TEST(OutlineMask, QuarterTurnsTurn) {
  test::Noise noise{9};
  for (int round = 0; round < 50; ++round) {
    const auto shape = test::blob(noise, 12, noise.in(3, 9));
    Vec2d origin;
    const Mask m = pack::rasterize(pack::outline_of({shape, {}}), {}, origin);
    const Mask turned = pack::quarter_turn(m);
    ASSERT_EQ(turned.width, m.height);
    ASSERT_EQ(turned.height, m.width);
    for (int y = 0; y < m.height; ++y)
      for (int x = 0; x < m.width; ++x)
        ASSERT_EQ(covers(m, x, y), covers(turned, m.height - 1 - y, x));
    EXPECT_EQ(pack::quarter_turn(pack::quarter_turn(pack::quarter_turn(turned))), m);
    EXPECT_EQ(pack::half_turn(m), pack::quarter_turn(turned));
  }
}

// Compares the search for a place with a scan over all cells, on pages of short and of long rows,
// for small and for long flat masks, within windows.
TEST(BitPage, FindsTheLowestLeftmostPlace) {
  test::Noise noise{17};
  int in_windows = 0;
  for (int round = 0; round < 120; ++round) {
    const int width = noise.in(20, round % 3 == 0 ? 700 : 300), height = 60;
    const bool flat = round % 2 == 1;
    BitPage page(width, height, width);
    std::vector<std::vector<bool>> taken(height, std::vector<bool>(std::size_t(width)));
    for (int k = 0; k < 25; ++k) {
      const int corners = noise.in(3, 8), radius = noise.in(2, flat ? width / 2 : 14);
      auto shape = test::blob(noise, radius, corners);
      if (flat) {
        for (Vec2d& p : shape) p.y *= 8.0 / width;
      }
      Vec2d origin;
      const Mask m = pack::rasterize(pack::outline_of({shape, {}}), {}, origin);
      BitPage::Window window;
      const bool bounded = noise.in(0, 2) == 0;
      if (bounded) window = {noise.in(0, width / 2), noise.in(0, width), noise.in(0, 20), 40};
      const auto free_at = [&](int x, int y) {
        for (int r = 0; r < m.height; ++r)
          for (const pack::Run& run : m.row(r))
            for (int c = run.begin; c < run.end; ++c)
              if (taken[std::size_t(y + r)][std::size_t(x + c)]) return false;
        return true;
      };
      BitPage::Place expected{-1, -1}, found{-1, -1};
      const int last_x = std::min(window.x1, width - m.width);
      const int last_y = std::min(window.y1, height - m.height);
      for (int y = window.y0; y <= last_y && expected.y < 0; ++y)
        for (int x = window.x0; x <= last_x && expected.y < 0; ++x)
          if (free_at(x, y)) expected = {x, y};
      const bool ok = page.find(pack::test_order(m), window, found);
      ASSERT_EQ(ok, expected.y >= 0);
      if (!ok) continue;
      in_windows += bounded;
      ASSERT_EQ(found.x, expected.x);
      ASSERT_EQ(found.y, expected.y);
      page.put(m, found);
      for (int r = 0; r < m.height; ++r)
        for (const pack::Run& run : m.row(r))
          for (int c = run.begin; c < run.end; ++c)
            taken[std::size_t(found.y + r)][std::size_t(found.x + c)] = true;
    }
  }
  EXPECT_GT(in_windows, 100);
}

}  // namespace
}  // namespace atlas
