// The parts of the press: distance fields, bodies that are pushed together, and exact places near
// the wanted ones.
#include "libatlas/pack/pressing/press.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libatlas/pack/pressing/contacts.h"
#include "libatlas/pack/pressing/settle.h"
#include "tests/pack/one_page.h"
#include "tests/support/layout_checks.h"

namespace atlas {
namespace {

using namespace pack;
using test::box;
using test::options_for;

Mask mask_of(const std::vector<Vec2d>& shape, int cell) {
  RasterOptions o;
  o.padding = 0;
  o.cell = cell;
  Vec2d origin;
  return rasterize(outline_of({shape, {}}), o, origin);
}

// Compares the field with the nearest of all cells, found by brute force.
TEST(DistanceField, MatchesTheNearestCell) {
  test::Noise noise{21};
  for (int round = 0; round < 20; ++round) {
    const Mask m = mask_of(test::blob(noise, 12, noise.in(3, 9)), 1);
    const double reach = 6;
    const DistanceField field(m, 1, reach);
    std::vector<std::vector<bool>> in(std::size_t(m.height),
                                      std::vector<bool>(std::size_t(m.width)));
    for (int y = 0; y < m.height; ++y)
      for (const pack::Run& r : m.row(y))
        for (int x = r.begin; x < r.end; ++x) in[std::size_t(y)][std::size_t(x)] = true;
    const auto inside = [&](int x, int y) {
      return x >= 0 && y >= 0 && x < m.width && y < m.height && in[std::size_t(y)][std::size_t(x)];
    };
    for (int y = -5; y < m.height + 5; ++y)
      for (int x = -5; x < m.width + 5; ++x) {
        double nearest = 1e300;  // distance to a cell on the other side of the border
        for (int v = -20; v < m.height + 20; ++v)
          for (int u = -20; u < m.width + 20; ++u)
            if (inside(u, v) != inside(x, y)) nearest = std::min(nearest, std::hypot(u - x, v - y));
        DistanceField::Sample s;
        ASSERT_TRUE(field.sample({x + 0.5, y + 0.5}, s));
        // Outside, distances are between centres of cells. Inside they are one cell less, because
        // half a cell comes off the mask.
        EXPECT_NEAR(s.distance, inside(x, y) ? 1 - nearest : nearest, 1e-4) << x << " " << y;
      }
    DistanceField::Sample s;
    EXPECT_FALSE(field.sample({-reach - 3, 0}, s));
  }
}

TEST(DistanceField, OutlinePointsLieOnTheOutline) {
  const Mask m = mask_of(box(60, 30), 2);
  const DistanceField field(m, 2, 12);
  const auto points = field.outline(6);
  EXPECT_GE(points.size(), 20u);
  for (const Vec2d& p : points) {
    DistanceField::Sample s;
    ASSERT_TRUE(field.sample(p, s));
    EXPECT_LT(std::abs(s.distance), 1.0);
  }
}

TEST(Squeeze, BodiesEndCloseAndApart) {
  // Four boxes lie loosely in the corners of a page nearly twice as wide as they need.
  const Mask m = mask_of(box(200, 100), 4);
  std::vector<Body> bodies(4, make_body(m, 4, 40, 16));
  const double side = 800;
  for (std::size_t k = 0; k < 4; ++k)
    bodies[k].at = {k % 2 ? side - 120 : 120.0, k / 2 ? side - 70 : 70.0};
  SqueezeOptions o;
  o.clearance = 4;
  o.margin = 2;
  const SqueezePage page = squeeze(bodies, {side, side}, o);
  const double fill = 4 * 200 * 100 / (page.width * page.height);
  EXPECT_GT(fill, 0.8);
  EXPECT_LT(fill, 1.0);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_GT(bodies[i].at.x, 40);
    EXPECT_LT(bodies[i].at.x, page.width - 40);
    // No outline point of one body lies deeper in another one than the tolerance.
    for (std::size_t j = 0; j < 4; ++j) {
      if (i == j) continue;
      for (const Vec2d& local : bodies[i].outline) {
        const double c = std::cos(bodies[i].angle), s = std::sin(bodies[i].angle);
        const double x = bodies[i].at.x + c * local.x - s * local.y - bodies[j].at.x;
        const double y = bodies[i].at.y + s * local.x + c * local.y - bodies[j].at.y;
        const double cj = std::cos(bodies[j].angle), sj = std::sin(bodies[j].angle);
        DistanceField::Sample sample;
        if (bodies[j].field.sample(
                {cj * x + sj * y + bodies[j].center.x, cj * y - sj * x + bodies[j].center.y},
                sample)) {
          EXPECT_GT(sample.distance, o.clearance - 2 * o.tolerance);
        }
      }
    }
  }
}

// While bodies move about, every point that touches another body or an edge must be among the
// contacts.
TEST(Contacts, ThoseThatTouchAreAlwaysKnown) {
  test::Noise noise{23};
  std::vector<Body> bodies;
  for (int k = 0; k < 7; ++k)
    bodies.push_back(make_body(mask_of(test::blob(noise, 60, noise.in(3, 9)), 4), 4, 40, 10));
  SqueezeOptions o;
  o.clearance = 4;
  const SqueezePage page{340, 300};
  std::vector<Pose> poses(bodies.size());
  for (Pose& p : poses) p.at = {40 + 260 * noise.unit(), 40 + 220 * noise.unit()};
  Contacts contacts(bodies, o);
  contacts.set_page(page, poses);
  const auto has = [](const std::vector<Contacts::Contact>& points, Vec2d p, double moved) {
    return std::any_of(points.begin(), points.end(),
                       [&](const Contacts::Contact& c) { return c.point == p && moved >= c.room; });
  };
  int touching = 0, edge = 0;
  const auto check = [&](std::size_t i, std::size_t j) {
    for (const Vec2d& local : bodies[i].outline) {
      const Vec2d p = poses[i].to_page(local), q = poses[j].to_body(p);
      DistanceField::Sample s;
      const Vec2d at{q.x + bodies[j].center.x, q.y + bodies[j].center.y};
      if (!bodies[j].field.sample(at, s) || s.distance >= o.clearance) continue;
      ++touching;
      bool known = false;
      for (std::size_t k = 0; k < contacts.near_count(); ++k) {
        const Contacts::Pair& pair = contacts.near(k);
        known = known || (pair.i == i && pair.j == j && has(pair.of_i, local, pair.moved)) ||
                (pair.i == j && pair.j == i && has(pair.of_j, local, pair.moved));
      }
      EXPECT_TRUE(known);
    }
  };
  for (int round = 0; round < 150; ++round) {
    contacts.update(poses);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      for (std::size_t j = 0; j < bodies.size(); ++j)
        if (i != j) check(i, j);
      const Contacts::Wall& wall = contacts.walls()[i];
      for (const Vec2d& local : bodies[i].outline) {
        const Vec2d p = poses[i].to_page(local);
        if (std::min({p.x, p.y, page.width - p.x, page.height - p.y}) >= o.margin) continue;
        ++edge;
        EXPECT_TRUE(has(wall.points, local, wall.moved));
      }
    }
    for (Pose& p : poses) {  // most moves are small, some large
      const double far = noise.in(0, 19) == 0 ? 60 : 3, turn = 0.05 * (noise.unit() - 0.5);
      p.at = {std::clamp(p.at.x + far * (noise.unit() - 0.5), 0.0, page.width),
              std::clamp(p.at.y + far * (noise.unit() - 0.5), 0.0, page.height)};
      const double c = p.cosine, s = p.sine;
      p.cosine = c * std::cos(turn) - s * std::sin(turn);
      p.sine = s * std::cos(turn) + c * std::sin(turn);
    }
  }
  EXPECT_GT(touching, 1000);
  EXPECT_GT(edge, 1000);
}

TEST(Squeeze, NoPageWhereOverlapsRemain) {
  // No push can separate bodies that share their centre.
  const Mask m = mask_of(box(200, 200), 4);
  std::vector<Body> bodies(9, make_body(m, 4, 40, 16));
  for (Body& b : bodies) b.at = {100, 100};
  SqueezeOptions o;
  const SqueezePage page = squeeze(bodies, {210, 210}, o);
  EXPECT_EQ(page.width * page.height, 0);
}

// Overlapping targets are moved apart or shrunk. The result keeps its gutters, no chart lies beyond
// its target by more than the tolerance, and none can move to the left.
TEST(Settle, PlacesAreExactAndClosedUp) {
  test::Noise noise{5};
  std::vector<std::vector<Vec2d>> blobs;
  for (int k = 0; k < 9; ++k) blobs.push_back(test::blob(noise, 36, 9));
  const test::ChartItems charts(std::move(blobs));
  const std::vector<ChartOutline> outlines = outlines_of(charts.shapes, {});
  std::vector<SettleTarget> targets(9);
  for (std::size_t k = 0; k < 9; ++k) {
    targets[k].origin = {40.0 + 70 * double(k % 3), 40.0 + 70 * double(k / 3)};
    targets[k].angle = 0.3 * double(k);
  }
  FitOptions o;
  o.page_size = 256;
  o.padding = 2;
  o.alignment = 1;
  const PressedPage page = settle({outlines, targets, 1}, o, {});
  ASSERT_GT(page.scale, 0.85);
  EXPECT_LE(page.scale, 1);
  std::vector<test::PlacedShape> placed;
  for (std::size_t k = 0; k < 9; ++k) {
    const PressedPlace& p = page.places[k];
    ASSERT_TRUE(p.placed);
    EXPECT_EQ(p.angle, targets[k].angle);
    placed.push_back({charts.shapes[k], 0, page.scale, p.angle, p.offset});
    EXPECT_LE(p.offset.x, targets[k].origin.x + 6);
    EXPECT_LE(p.offset.y, targets[k].origin.y + 6);
  }
  const std::vector<Extent> pages{page.page};
  EXPECT_EQ(test::check_outlines(placed, pages, o.padding), "");
  for (test::PlacedShape& p : placed) {
    p.offset.x -= 1;
    EXPECT_NE(test::check_outlines(placed, pages, o.padding), "");
    p.offset.x += 1;
  }
}

// The whole press: its page is fuller than that of the cells it starts from, keeps the gutters, and
// is the same for every number of threads.
TEST(Press, FewChartsOnOnePage) {
  test::Noise noise{8};
  std::vector<std::vector<Vec2d>> blobs;
  for (int k = 0; k < 12; ++k) blobs.push_back(test::blob(noise, 60 + 100 * noise.unit(), 9));
  const test::ChartItems charts(std::move(blobs));
  FitOptions o = options_for(charts, 512);
  o.power_of_two = false;
  const auto [pressed, again, cells] = test::press_and_fill(charts, o);
  ASSERT_TRUE(pressed.ok() && again.ok() && cells.ok());
  EXPECT_GT(pressed->utilization, cells->utilization);
  EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, *pressed), pressed->pages, 1), "");
  test::expect_same(*pressed, *again);
}

// Thin zigzags that reach into each other, turned by multiples of half a radian.
test::ChartItems zigzags(int count, int teeth, double height, double width) {
  std::vector<std::vector<Vec2d>> shapes;
  for (int k = 0; k < count; ++k) {
    std::vector<Vec2d> corners;
    for (int x = 0; x < teeth; ++x) {
      const double low = x % 2 * height, high = height - low;
      const Vec2d a{double(x), low}, b{x + 1.0, high}, c{x + 1.0, high + width},
          d{a.x, low + width};
      corners.insert(corners.end(), {a, b, c, a, c, d});
    }
    for (Vec2d& p : corners)
      p = {std::cos(0.5 * k) * p.x - std::sin(0.5 * k) * p.y,
           std::sin(0.5 * k) * p.x + std::cos(0.5 * k) * p.y};
    shapes.push_back(std::move(corners));
  }
  return test::ChartItems(std::move(shapes));
}

// Where pressing fills little of a page, the search over cells may fill half as much again.
TEST(Press, PagesThatStayEmptyAreAlsoFilledByCells) {
  const test::ChartItems charts = zigzags(12, 3, 4, 0.5);
  FitSearchOptions o = options_for(charts, 128);
  o.free_aspect = false;
  o.rotations = 16;
  const PressedPage pressed = press_outlines(outlines_of(charts.shapes, {}), o, {});
  ASSERT_GT(pressed.scale, 0);
  FitSearchOptions by_cells = o;
  by_cells.any_angle = false;
  const Result<FitResult> fit = fit_pages(charts.items, o, {}),
                          cells = fit_pages(charts.items, by_cells, {});
  ASSERT_TRUE(fit.ok() && cells.ok());
  EXPECT_GT(cells->scale, 1.05 * pressed.scale);
  EXPECT_EQ(fit->scale, cells->scale);
}

// A chart that is longer than the side of a square page for all charts lies along a long page.
TEST(Press, LongChartsLieAlongThePage) {
  std::vector<std::vector<Vec2d>> bars;
  for (int k = 0; k < 24; ++k) {
    const double w = k < 3 ? 2000 - 10 * k : 60 + 2 * k, h = k < 3 ? 30 : 40 + k;
    bars.push_back({{0, 0}, {w, 0}, {w, h}, {0, 0}, {w, h}, {0, h}});
  }
  const test::ChartItems charts(std::move(bars));
  FitOptions o = options_for(charts, 2048);
  o.max_scale = 10;
  const Result<FitResult> r = fit_pages(charts.items, o, {});
  ASSERT_TRUE(r.ok());
  EXPECT_GT(r->utilization, 0.6);
  EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, *r), r->pages, o.padding), "");
}

// Two discs do not fill a square page, but one half as high.
TEST(Press, FewLargeChartsLieInOneRow) {
  std::vector<std::vector<Vec2d>> shapes(2);
  for (int i = 0; i < 60; ++i) {
    const auto at = [](double k) {
      return Vec2d{100 * std::cos(k * std::numbers::pi / 30),
                   100 * std::sin(k * std::numbers::pi / 30)};
    };
    for (auto& disc : shapes) disc.insert(disc.end(), {Vec2d{0, 0}, at(i), at(i + 1)});
  }
  shapes.push_back(box(70, 2));
  const test::ChartItems charts(std::move(shapes));
  const Result<FitResult> r = fit_pages(charts.items, options_for(charts, 1024), {});
  ASSERT_TRUE(r.ok());
  EXPECT_GT(r->utilization, 0.74);
  EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, *r), r->pages, 1), "");
}

// At the largest scale the strip is as long as the page may be, and three plates lie beside each
// other. At a slightly smaller scale four do.
TEST(Fit, AFreePageIsFilledBeforeItIsLarge) {
  std::vector<std::vector<Vec2d>> shapes{box(1400, 16)};
  for (int k = 0; k < 4; ++k) shapes.push_back(box(375, 335));
  for (int k = 0; k < 200; ++k) shapes.push_back(box(8 + k % 7, 6 + k % 5));
  const test::ChartItems charts(std::move(shapes));
  FitOptions o = options_for(charts, 2048);
  const Result<FitResult> r = fit_pages(charts.items, o, {});
  ASSERT_TRUE(r.ok());
  EXPECT_GT(r->utilization, 0.85);
  EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, *r), r->pages, 1), "");
}

}  // namespace
}  // namespace atlas
