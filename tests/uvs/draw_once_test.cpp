// No texel is drawn twice. Checked with another rasteriser (tests/support/atlas_measure.h) on
// random slivers, among neighbours that leave no more space than gutters do.
#include "libatlas/uvs/draw_once.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "libatlas/uvs/thin_uvs.h"
#include "tests/support/atlas_measure.h"

namespace atlas::test {
namespace {

constexpr std::int32_t kPage = 1024;

// Charts on one page, given by their texels.
struct Drawn {
  ChartSet set;
  std::vector<ChartPlacement> placements;
  std::vector<Extent> pages{{kPage, kPage}};
  std::vector<Vec2f> uvs;

  // `corners` has three indices into `texels` per triangle.
  void add(const std::vector<Vec2d>& texels, const std::vector<std::uint32_t>& corners) {
    Chart chart;
    chart.first_uv = std::uint32_t(uvs.size());
    chart.uv_count = std::uint32_t(texels.size());
    chart.first_triangle = std::uint32_t(set.triangle_chart.size());
    chart.triangle_count = std::uint32_t(corners.size() / 3);
    for (const Vec2d t : texels) uvs.push_back({float(t.x / kPage), float(t.y / kPage)});
    for (std::size_t i = 0; i < corners.size(); ++i) {
      set.triangle_uv.push_back(chart.first_uv + corners[i]);
      if (i % 3 != 0) continue;
      set.chart_triangles.push_back(std::uint32_t(set.triangle_chart.size()));
      set.triangle_chart.push_back(std::uint32_t(set.charts.size()));
    }
    ChartPlacement placement;
    placement.chart = std::uint32_t(set.charts.size());
    placement.page = 0;
    placements.push_back(placement);
    set.charts.push_back(chart);
  }

  DrawnTwice draw(int threads) {
    Context context;
    context.threads = threads;
    return draw_once({set, placements, pages}, set.triangle_uv, uvs, context);
  }

  AtlasMeasures measured() const {
    UvMesh mesh;
    for (const Vec2f uv : uvs) {
      mesh.uvs.push_back({uv.x, uv.y});
      mesh.positions.push_back({uv.x, uv.y, 0});
    }
    for (std::size_t i = 0; i < set.triangle_uv.size(); i += 3) {
      const std::uint32_t* c = &set.triangle_uv[i];
      mesh.faces.push_back({{c[0], c[1], c[2]}, {c[0], c[1], c[2]}, 0});
    }
    return measure_atlas(mesh, kPage, kPage);
  }
};

// A kite whose lower sides bulge by thousandths of a texel, which makes slivers under proper
// triangles. Walls lie `gap` texels below, above, left and right of it.
Drawn kite_between_walls(unsigned seed, double gap) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const Vec2d a{40 + unit(random), 480 + 60 * unit(random)},
      b{960 + unit(random), 480 + 60 * unit(random)}, c{500 + 50 * unit(random), 900.5},
      d{500 + 50 * unit(random), 100.5};
  Drawn drawn;
  std::vector<Vec2d> texels{a, d, b, c};
  std::vector<std::uint32_t> corners{0, 1, 2, 0, 2, 3};
  for (const auto& [from, to] : {std::pair{0u, 1u}, std::pair{1u, 2u}}) {
    const Vec2d p = texels[from], q = texels[to];
    const double length = std::hypot(q.x - p.x, q.y - p.y),
                 out = 0.0003 * (1 + unit(random)) / length;
    texels.push_back({(p.x + q.x) / 2 + out * (q.y - p.y), (p.y + q.y) / 2 - out * (q.x - p.x)});
    corners.insert(corners.end(), {from, std::uint32_t(texels.size() - 1), to});
  }
  drawn.add(texels, corners);
  const auto wall = [&](Vec2d low, Vec2d high) {
    drawn.add({low, {high.x, low.y}, high, {low.x, high.y}}, {0, 1, 2, 0, 2, 3});
  };
  wall({200, d.y - gap - 20}, {800, d.y - gap});
  wall({200, c.y + gap}, {800, c.y + gap + 20});
  wall({a.x - gap - 20, 300}, {a.x - gap, 700});
  wall({b.x + gap, 300}, {b.x + gap + 20, 700});
  return drawn;
}

TEST(DrawOnce, NoTexelIsDrawnTwiceBetweenNeighbours) {
  int hit = 0, held = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(seed);
    Drawn drawn = kite_between_walls(seed, 2.1);
    const std::vector<Vec2f> before = drawn.uvs;
    const AtlasMeasures first = drawn.measured();
    ASSERT_EQ(first.bleed, 0u);
    const DrawnTwice result = drawn.draw(2);
    EXPECT_GE(result.before, first.overlap);  // edges count there, whatever the orientation
    const AtlasMeasures last = drawn.measured();
    EXPECT_EQ(last.bleed, 0u);
    EXPECT_EQ(last.flipped, first.flipped);
    EXPECT_LE(last.overlap, result.after);
    EXPECT_LE(result.after, result.before);
    hit += first.overlap > 0;
    held += result.after > 0;
    if (result.before == 0) {
      EXPECT_EQ(drawn.uvs, before);
    }
    for (const DrawnTwice::Move& move : result.moves) {
      EXPECT_EQ(move.chart, 0u);
      EXPECT_EQ(256 * move.texels.x, std::round(256 * move.texels.x));
      EXPECT_LE(std::hypot(move.texels.x, move.texels.y), 0.36);
      for (int i = 0; i < 4; ++i) {
        EXPECT_NEAR(kPage * (drawn.uvs[i].x - before[i].x), move.texels.x, 2e-4);
        EXPECT_NEAR(kPage * (drawn.uvs[i].y - before[i].y), move.texels.y, 2e-4);
      }
    }
    Drawn again = kite_between_walls(seed, 2.1);
    again.draw(1);
    EXPECT_EQ(again.uvs, drawn.uvs);
  }
  EXPECT_GE(hit, 10);  // otherwise the slivers would show nothing
  EXPECT_LE(held, 2);
}

// A page full of small diamonds side by side, each with slivers along its sides. Slightly more than
// two texels lie between them. Texel centres lie very close to their sides, so that many slivers
// cover some.
Drawn crowd(unsigned seed) {
  Drawn drawn;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  constexpr double kCell = 32.5, kRadius = 14;
  for (int row = 0; row < 56; ++row) {
    for (int column = 0; column < 28; ++column) {
      const double x = kCell * (1 + column + 0.5 * (row % 2)), y = kCell * (1 + 0.5 * row);
      std::vector<Vec2d> texels{
          {x, y - kRadius}, {x + kRadius, y}, {x, y + kRadius}, {x - kRadius, y}};
      for (Vec2d& p : texels) p = {p.x + 0.008 * unit(random), p.y + 0.008 * unit(random)};
      std::vector<std::uint32_t> corners{0, 1, 2, 0, 2, 3};
      for (std::uint32_t k = 0; k < 4; ++k) {
        const Vec2d p = texels[k], q = texels[(k + 1) % 4];
        const double length = std::hypot(q.x - p.x, q.y - p.y),
                     out = 0.0003 * (1 + unit(random)) / length;
        texels.push_back(
            {(p.x + q.x) / 2 + out * (q.y - p.y), (p.y + q.y) / 2 - out * (q.x - p.x)});
        corners.insert(corners.end(), {k, std::uint32_t(texels.size() - 1), (k + 1) % 4});
      }
      drawn.add(texels, corners);
    }
  }
  return drawn;
}

TEST(DrawOnce, NeighboursOfNeighboursThatMovedStayApart) {
  Drawn drawn = crowd(7), again = crowd(7);
  const AtlasMeasures first = drawn.measured();
  ASSERT_EQ(first.bleed, 0u);
  const std::vector<Vec2f> before = drawn.uvs;
  const DrawnTwice counted =
      drawn_twice({drawn.set, drawn.placements, drawn.pages}, drawn.set.triangle_uv, drawn.uvs, {});
  EXPECT_EQ(drawn.uvs, before);
  const DrawnTwice result = drawn.draw(2);
  EXPECT_EQ(counted.before, result.before);
  EXPECT_EQ(counted.after, result.before);
  EXPECT_TRUE(counted.moves.empty());
  EXPECT_GE(result.moves.size(), 50u);  // otherwise few moved charts would have moved neighbours
  EXPECT_LT(result.after, result.before / 4);
  const AtlasMeasures last = drawn.measured();
  EXPECT_EQ(last.bleed, 0u);
  EXPECT_EQ(last.flipped, first.flipped);
  EXPECT_LE(last.overlap, result.after);
  again.draw(1);
  EXPECT_EQ(again.uvs, drawn.uvs);
}

// A chart that cannot be moved comes before one on another page that is.
TEST(DrawOnce, EachChartIsMovedForItself) {
  unsigned seed = 50;
  while (kite_between_walls(seed, 2.1).draw(1).moves.empty()) ++seed;
  int held = 0;
  for (unsigned first = 0; first < 100 && held < 3; ++first) {
    Drawn both = kite_between_walls(first, 1.2), second = kite_between_walls(seed, 2.1);
    {
      Drawn alone = both;
      const DrawnTwice drawn = alone.draw(1);
      if (drawn.before == 0 || !drawn.moves.empty()) continue;
    }
    ++held;
    const auto charts = std::uint32_t(both.set.charts.size());
    const std::size_t before = both.uvs.size();
    both.pages.push_back(both.pages[0]);
    for (const Chart& chart : second.set.charts) {
      std::vector<Vec2d> texels;
      for (const Vec2f uv : std::span(second.uvs).subspan(chart.first_uv, chart.uv_count))
        texels.push_back({kPage * double(uv.x), kPage * double(uv.y)});
      std::vector<std::uint32_t> corners;
      for (std::uint32_t i = 0; i < 3 * chart.triangle_count; ++i)
        corners.push_back(second.set.triangle_uv[3 * chart.first_triangle + i] - chart.first_uv);
      both.add(texels, corners);
      both.placements.back().page = 1;
    }
    const DrawnTwice together = both.draw(1);
    const DrawnTwice alone = second.draw(1);
    ASSERT_EQ(together.moves.size(), 1u);
    EXPECT_EQ(together.moves[0].chart, charts + alone.moves[0].chart);
    EXPECT_TRUE(std::equal(second.uvs.begin(), second.uvs.end(),
                           both.uvs.begin() + std::ptrdiff_t(before)));
  }
  EXPECT_GE(held, 1);
}

TEST(DrawOnce, StaysWhereEveryMoveWouldTouchNeighbours) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    // Closer than gutters, so none may come even closer.
    Drawn drawn = kite_between_walls(seed, 1.2);
    const std::uint64_t bleed = drawn.measured().bleed;
    drawn.draw(1);
    EXPECT_LE(drawn.measured().bleed, bleed) << seed;
  }
}

// The kite lies a little more than a texel from the page's edges, so most moves are too long.
TEST(DrawOnce, ChartsStayATexelOffThePagesEdge) {
  std::size_t moved = 0;
  for (unsigned seed = 0; seed < 600; ++seed) {
    const Drawn walled = kite_between_walls(seed, 2.1);
    std::vector<Vec2d> texels;
    Vec2d low{kPage, kPage};
    for (std::uint32_t i = 0; i < walled.set.charts[0].uv_count; ++i) {
      texels.push_back({kPage * double(walled.uvs[i].x), kPage * double(walled.uvs[i].y)});
      low = {std::min(low.x, texels[i].x), std::min(low.y, texels[i].y)};
    }
    for (Vec2d& t : texels)
      t = {t.x - low.x + 1 + seed / 6000.0, t.y - low.y + 1 + seed % 7 / 70.0};
    const auto corners = std::span(walled.set.triangle_uv)
                             .first(3 * std::size_t(walled.set.charts[0].triangle_count));
    Drawn drawn;
    drawn.add(texels, {corners.begin(), corners.end()});
    moved += drawn.draw(1).moves.size();
    for (const Vec2f uv : drawn.uvs) {
      EXPECT_GE(kPage * uv.x, 1) << seed;
      EXPECT_GE(kPage * uv.y, 1) << seed;
    }
  }
  EXPECT_GT(moved, 5u);
}

// Adds a sheet with vertical sides, or such that lean, of slanted rows with a sliver on each.
void add_sheet(Drawn& drawn, double left, double right, std::mt19937& random, double lean = 0) {
  constexpr std::uint32_t kRows = 30;
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec2d> texels;
  std::vector<std::uint32_t> corners;
  for (std::uint32_t row = 0; row <= kRows; ++row) {
    const double low = 100 + 20 * row + unit(random), high = low + 16 * unit(random);
    texels.push_back({left, low});
    texels.push_back({(left + right) / 2, (low + high) / 2 + 0.0003 * (1 + unit(random))});
    texels.push_back({right, high});
    const std::uint32_t a = 3 * row, b = a + 1, c = a + 2, d = a + 3, e = a + 5;
    corners.insert(corners.end(), {a, c, b});
    if (row < kRows) corners.insert(corners.end(), {a, b, d, b, c, e, b, e, d});
  }
  for (Vec2d& t : texels) t.x += lean * (t.y - 100);
  drawn.add(texels, corners);
}

// Two charts with sides slightly more than two texels apart are both moved. Either of them alone
// may come nearer to where the other was, but if both did, lookups of both would read one texel.
TEST(DrawOnce, NeighboursThatMovedAreSeenWhereTheyAre) {
  int both = 0;
  for (unsigned seed = 0; seed < 150; ++seed) {
    std::mt19937 random(seed);
    Drawn drawn;
    const std::pair<double, double> left{60, 300.498}, right{302.502, 550};
    for (const auto& [from, to] : {seed % 2 ? left : right, seed % 2 ? right : left})
      add_sheet(drawn, from, to, random);
    both += drawn.draw(1).moves.size() == 2;
    EXPECT_EQ(drawn.measured().bleed, 0u) << seed;
  }
  EXPECT_GT(both, 20);
}

// Look-ups along leaning sides read texels further out along both axes.
TEST(DrawOnce, LeaningNeighboursStayApart) {
  for (const double lean : {0.3, -0.2}) {
    int moved = 0;
    for (unsigned seed = 0; seed < 15; ++seed) {
      std::mt19937 random(seed);
      Drawn drawn;
      add_sheet(drawn, 160, 400.498, random, lean);
      add_sheet(drawn, 400.498 + 2.02 * (1 + std::fabs(lean)), 650, random, lean);
      moved += int(drawn.draw(1).moves.size());
      EXPECT_EQ(drawn.measured().bleed, 0u) << seed << ' ' << lean;
    }
    EXPECT_GT(moved, 5) << lean;
  }
}

// Where a page's side is no power of two, a move rounds uvs anew, which may close slivers that are
// just open. Such a move is not made.
TEST(DrawOnce, NoMoveClosesASliver) {
  std::size_t moved = 0;
  for (unsigned seed = 0; seed < 600; ++seed) {
    Drawn drawn = kite_between_walls(seed, 2.1);
    drawn.pages = {{1000, 1000}};
    const auto thin = [&](std::size_t triangle) {
      return is_thin(std::span(drawn.set.triangle_uv).subspan(3 * triangle).first<3>(), drawn.uvs);
    };
    for (const std::size_t sliver : {2, 3}) {
      float& height = drawn.uvs[drawn.set.triangle_uv[3 * sliver + 1]].y;
      ASSERT_FALSE(thin(sliver));
      float least = height;
      for (; !thin(sliver); height = std::nextafter(height, 1.0F)) least = height;
      height = least;
    }
    moved += drawn.draw(1).moves.size();
    for (std::size_t t = 0; t < drawn.set.triangle_chart.size(); ++t) EXPECT_FALSE(thin(t)) << seed;
  }
  EXPECT_GT(moved, 20u);
}

TEST(DrawOnce, LeavesChartsThatCancellingLeft) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    Drawn drawn = kite_between_walls(seed, 2.1);
    const std::vector<Vec2f> before = drawn.uvs;
    Context context;
    const std::atomic<bool> cancel = true;
    context.cancel = &cancel;
    draw_once({drawn.set, drawn.placements, drawn.pages}, drawn.set.triangle_uv, drawn.uvs,
              context);
    EXPECT_EQ(drawn.uvs, before);
  }
}

}  // namespace
}  // namespace atlas::test
