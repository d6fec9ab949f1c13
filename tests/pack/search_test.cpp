// The engines below the public functions: freed space is found again, and bounds hold.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <tuple>
#include <vector>

#include "libatlas/core/clock.h"
#include "libatlas/pack/rectangles/engines.h"
#include "libatlas/pack/rectangles/gap_fill.h"
#include "libatlas/pack/rectangles/height_index.h"
#include "libatlas/pack/rectangles/skyline.h"
#include "libatlas/pack/rectangles/strip_beam.h"
#include "tests/support/layout_checks.h"
#include "tests/support/slowness.h"

namespace atlas {
namespace {

using namespace pack;

// Compares the maximal free rectangles with all rectangles of a small grid.
TEST(FreeRects, HoldExactlyTheMaximalRectangles) {
  test::Noise noise{4};
  for (int round = 0; round < 200; ++round) {
    constexpr int n = 9;
    FreeRects page({n, n});
    int taken[n][n] = {};  // by how many rectangles
    int top = 0;
    const auto mark = [&](const Rect& r, int step) {
      for (int y = r.y; y < r.top(); ++y)
        for (int x = r.x; x < r.right(); ++x) taken[y][x] += step;
    };
    std::vector<Rect> gone;
    for (int k = noise.in(1, 6); k > 0; --k) {
      const int x = noise.in(0, n - 1), y = noise.in(0, n - 1);
      const Rect r{x, y, noise.in(1, n - x), noise.in(1, n - y)};
      page.place(r);
      mark(r, 1);
      if (noise.in(0, 2) == 0) gone.push_back(r);
    }
    for (const Rect& r : gone) {
      page.take_away(r);
      mark(r, -1);
    }
    for (int y = 0; y < n; ++y)
      if (std::any_of(taken[y], taken[y] + n, [](int t) { return t > 0; })) top = y + 1;
    ASSERT_EQ(page.used_height(), top);
    const auto is_free = [&](int x0, int y0, int x1, int y1) {
      if (x0 < 0 || y0 < 0 || x1 > n || y1 > n) return false;
      for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x)
          if (taken[y][x]) return false;
      return true;
    };
    std::vector<Rect> expected;
    for (int y0 = 0; y0 < n; ++y0)
      for (int x0 = 0; x0 < n; ++x0)
        for (int x1 = x0 + 1; x1 <= n; ++x1)
          for (int y1 = y0 + 1; y1 <= n; ++y1)
            if (is_free(x0, y0, x1, y1) && !is_free(x0 - 1, y0, x1, y1) &&
                !is_free(x0, y0 - 1, x1, y1) && !is_free(x0, y0, x1 + 1, y1) &&
                !is_free(x0, y0, x1, y1 + 1))
              expected.push_back({x0, y0, x1 - x0, y1 - y0});
    std::vector<Rect> found = page.free();
    const auto less = [](const Rect& a, const Rect& b) {
      return std::tie(a.x, a.y, a.width, a.height) < std::tie(b.x, b.y, b.width, b.height);
    };
    std::sort(found.begin(), found.end(), less);
    std::sort(expected.begin(), expected.end(), less);
    ASSERT_EQ(found, expected);
  }
}

TEST(Skyline, WasteIsUsedAgain) {
  Skyline page({10, 10});
  const auto put = [&](Extent e) {
    Spot spot;
    EXPECT_TRUE(page.find(e, false, PlaceRule::bottom_left, spot));
    page.place(spot.rect);
    return spot.rect;
  };
  EXPECT_EQ(put({4, 6}), (Rect{0, 0, 4, 6}));
  EXPECT_EQ(put({6, 2}), (Rect{4, 0, 6, 2}));
  EXPECT_EQ(put({8, 4}), (Rect{0, 6, 8, 4}));  // covers a free 4 x 4 area above the second item
  EXPECT_EQ(put({4, 4}), (Rect{4, 2, 4, 4}));
}

// The first place over a skyline of column heights by a rule: all left ends at which the height
// changes are tried.
Spot place_over(const std::vector<int>& heights, Extent item, PlaceRule rule, int page_height) {
  Spot best;
  best.first = -1;
  const int width = int(heights.size());
  for (int x = 0; x + item.width <= width; ++x) {
    if (x > 0 && heights[x] == heights[x - 1]) continue;
    const auto window = heights.begin() + x;
    const int y = *std::max_element(window, window + item.width);
    if (y + item.height > page_height) continue;
    Spot s;
    s.rect = {x, y, item.width, item.height};
    const int waste = y * item.width - std::accumulate(window, window + item.width, 0);
    s.first = rule == PlaceRule::min_waste ? waste : y + item.height;
    s.second = rule == PlaceRule::min_waste ? y + item.height : waste;
    s.third = x;
    if (best.first < 0 || s.better_than(best)) best = s;
  }
  return best;
}

TEST(Skyline, FindsTheBestPlaceByItsRule) {
  constexpr Extent kPage{40, 60};
  test::Noise noise{17};
  int over = 0;
  for (int round = 0; round < 300; ++round) {
    const PlaceRule rule = round % 2 ? PlaceRule::min_waste : PlaceRule::bottom_left;
    const bool turns = round % 4 / 2;
    Skyline page(kPage);
    std::vector<int> heights(kPage.width, 0);
    for (;;) {
      const Extent item{noise.in(1, 12), noise.in(1, 12)};
      Spot found;
      const bool fits = page.find(item, turns, rule, found);
      const Spot upright = place_over(heights, item, rule, kPage.height);
      const Spot turned = place_over(heights, {item.height, item.width}, rule, kPage.height);
      if (!fits) {
        EXPECT_LT(upright.first, 0);
        EXPECT_TRUE(!turns || turned.first < 0);
        break;
      }
      page.place(found.rect);
      const auto window = heights.begin() + found.rect.x;
      const bool wasted =
          found.rect.y < *std::max_element(window, window + found.rect.width);  // below it
      if (wasted) {
        for (int k = 0; k < found.rect.width; ++k)
          ASSERT_LE(found.rect.top(), window[k]) << "what is wasted lies below the skyline";
        continue;
      }
      const bool turn =
          turns && turned.first >= 0 && (upright.first < 0 || turned.better_than(upright));
      ASSERT_EQ(found.rect, (turn ? turned : upright).rect) << round;
      ASSERT_EQ(found.first, (turn ? turned : upright).first);
      std::fill_n(window, found.rect.width, found.rect.top());
      ++over;
    }
    EXPECT_EQ(page.used_height(), *std::max_element(heights.begin(), heights.end()));
  }
  EXPECT_GT(over, 5000);
}

// Cuts a strip into items by guillotine cuts, so that a layout without waste exists.
std::vector<Extent> cut_strip(test::Noise& noise, Extent strip, std::size_t count) {
  std::vector<Extent> parts{strip};
  while (parts.size() < count) {
    const auto largest = std::max_element(parts.begin(), parts.end(), [](Extent a, Extent b) {
      return std::max(a.width, a.height) < std::max(b.width, b.height);
    });
    Extent rest = *largest;
    if (largest->width > largest->height) {
      largest->width = noise.in(1, rest.width - 1);
      rest.width -= largest->width;
    } else {
      largest->height = noise.in(1, rest.height - 1);
      rest.height -= largest->height;
    }
    parts.push_back(rest);
  }
  return parts;
}

TEST(StripBeam, LayoutsAreValidAndAsLowAsAsked) {
  test::Noise noise{12};
  int full = 0, found = 0;
  for (int round = 0; round < 60; ++round) {
    const Extent strip{noise.in(10, 60), noise.in(10, 60)};
    const auto items = cut_strip(noise, strip, std::size_t(noise.in(2, 14)));
    const bool rotate = noise.in(0, 1);
    StripBeam beam(items, strip.width, rotate);
    for (int slack : {0, strip.height / 8 + 1}) {
      const auto placed = beam.pack({strip.height + slack, 64, 3, {}});
      if (placed.empty()) continue;
      ++(slack ? found : full);
      std::vector<Placement> at(items.size());
      for (const GapPlacement& g : placed) at[g.item] = {0, g.x, g.y, g.rotated};
      for (const Placement& p : at) ASSERT_TRUE(p.placed());
      PackOptions o;
      o.allow_rotation = rotate;
      const std::vector<Extent> pages{{strip.width, strip.height + slack}};
      ASSERT_EQ(test::check_layout(items, at, pages, o), "");
    }
    EXPECT_TRUE(beam.pack({strip.height - 1, 64, 3, {}}).empty());  // less than the items' area
  }
  EXPECT_GE(full, 30);
  EXPECT_GE(found, 50);
}

TEST(StripSearch, TurnsHelpAndThreadsChangeNothing) {
  test::Noise noise{3};
  const auto items = cut_strip(noise, {100, 100}, 40);
  PackOptions o;
  o.page = {100, 0};
  o.allow_rotation = true;
  const Result<PackResult> standard = pack_rects(items, o, {});
  o.preset = PackPreset::best;
  o.effort = 6000;
  o.time_budget = 1e9;
  Context one, three;
  one.threads = 1;
  three.threads = 3;
  const Result<PackResult> a = pack_rects(items, o, one), b = pack_rects(items, o, three);
  ASSERT_TRUE(standard.ok() && a.ok() && b.ok());
  EXPECT_EQ(a->placements, b->placements);
  EXPECT_LE(a->pages[0].height, 103);
  EXPECT_LE(standard->pages[0].height, 104);
  EXPECT_EQ(test::check_layout(items, a->placements, a->pages, o), "");
}

// Compares what the index finds with a look at every item, for any order of the items.
TEST(GapPages, AreThoseOfGapFill) {
  test::Noise noise{17};
  for (int round = 0; round < 1500; ++round) {
    std::vector<Extent> items(std::size_t(noise.in(1, 60)));
    const int longest = noise.in(1, 40);
    for (Extent& e : items) e = {noise.in(1, longest), noise.in(1, longest)};
    Problem problem;
    problem.items = items;
    problem.page = {noise.in(longest, 100), noise.in(longest, 100)};
    problem.allow_rotation = noise.in(0, 1);
    std::vector<std::uint32_t> sequence = sorted_items(items, Order(noise.in(0, 4)));
    if (noise.in(0, 1)) std::reverse(sequence.begin(), sequence.end());
    const Layout layout = pack_gaps(problem, sequence);
    std::vector<Placement> expected(items.size());
    GapFill fill(items, problem.page, problem.allow_rotation);
    std::uint32_t page = 0;
    for (; !sequence.empty(); ++page) {
      fill.clear();
      fill.fill(sequence);
      for (const GapPlacement& g : fill.placed()) expected[g.item] = {page, g.x, g.y, g.rotated};
    }
    ASSERT_EQ(layout.placements, expected) << round;
    ASSERT_EQ(layout.pages, page);
  }
}

TEST(GapPages, StopAtTheMostPages) {
  const std::vector<Extent> items(10, {5, 5});
  Problem problem;
  problem.items = items;
  problem.page = {10, 10};
  problem.max_pages = 2;
  const Layout layout = pack_gaps(problem, sorted_items(items, Order::area));
  EXPECT_EQ(layout.pages, 2u);
  EXPECT_EQ(layout.unplaced, 2u);
}

// About ten items fit on a page. For the two sets, free rectangles took 190 and 121 pages, and the
// fast preset 186 and 113.
TEST(LargeSets, OfFewItemsAPageTakeFewPages) {
  test::Noise noise{11};
  std::vector<Extent> thick(2000), long_ones(2000);
  for (Extent& e : thick) e = {noise.in(300, 899), noise.in(300, 899)};
  for (Extent& e : long_ones) {
    e = {noise.in(600, 999), noise.in(20, 119)};
    if (noise.in(0, 1)) std::swap(e.width, e.height);
  }
  const auto pages = [](const std::vector<Extent>& items, int side, PackPreset preset, bool turn) {
    PackOptions o;
    o.page = {side, side};
    o.preset = preset;
    o.allow_rotation = turn;
    const Result<PackResult> r = pack_rects(items, o, {});
    EXPECT_EQ(test::check_layout(items, r->placements, r->pages, o), "");
    return r->pages.size();
  };
  for (const bool turn : {false, true}) {
    const std::size_t fast[] = {pages(thick, 2048, PackPreset::fast, turn),
                                pages(long_ones, 1024, PackPreset::fast, turn)};
    EXPECT_LE(pages(thick, 2048, PackPreset::standard, turn), fast[0] * 99 / 100);
    EXPECT_LE(pages(long_ones, 1024, PackPreset::standard, turn), fast[1] * 97 / 100);
  }
}

// In large sets, items that may be rotated are packed no worse than items that may not. On strips,
// that takes about the same time.
TEST(Turns, NeverCostRoomInLargeSets) {
  test::Noise noise{5};
  std::vector<Extent> items(2000);
  for (Extent& e : items) e = {noise.in(1, 64), noise.in(1, 64)};
  for (const Extent page :
       {Extent{512, 512}, Extent{1024, 0}, Extent{8192, 0}, Extent{700, 2000}}) {
    PackOptions o;
    o.page = page;
    const Result<PackResult> fixed = pack_rects(items, o, {});
    o.allow_rotation = true;
    const Result<PackResult> turned = pack_rects(items, o, {});
    ASSERT_TRUE(fixed.ok() && turned.ok());
    EXPECT_EQ(test::check_layout(items, turned->placements, turned->pages, o), "");
    EXPECT_LE(turned->pages.size(), fixed->pages.size()) << page.width;
    EXPECT_LE(turned->pages.back().height, fixed->pages.back().height) << page.width;
  }
  // An item that fits in one orientation only is rotated accordingly, whatever the others are.
  items.push_back({60, 500});
  items.push_back({500, 60});
  PackOptions o;
  o.page = {512, 100};
  o.allow_rotation = true;
  const Result<PackResult> low = pack_rects(items, o, {});
  ASSERT_TRUE(low.ok());
  EXPECT_TRUE(low->unplaced.empty());
  EXPECT_TRUE(low->placements[2000].rotated);
  EXPECT_FALSE(low->placements[2001].rotated);
  EXPECT_EQ(test::check_layout(items, low->placements, low->pages, o), "");
}

// One layout of this many items takes a good part of a second, and four chains would try sixteen.
TEST(Budget, LargeSetsEndNearIt) {
  test::Noise noise{7};
  std::vector<Extent> items(60000);
  for (Extent& e : items) e = {noise.in(1, 64), noise.in(1, 64)};
  PackOptions o;
  o.page = {2048, 2048};
  o.preset = PackPreset::best;
  o.time_budget = 1e-3;
  const Result<PackResult> result = pack_rects(items, o, {});
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result->layouts_tried, 1u);
  EXPECT_EQ(test::check_layout(items, result->placements, result->pages, o), "");
}

// Each item meets free rectangles by the thousand, of which each leaves a piece beside it.
TEST(FreeRects, ThousandsOfThinItemsTakeLittleTime) {
  test::Noise noise{9};
  std::vector<Extent> items(5000);
  for (Extent& e : items) e = {noise.in(1, 8192), 1};
  PackOptions o;
  o.page = {8192, 8192};
  const double begun = cpu_seconds();
  const Result<PackResult> result = pack_rects(items, o, {});
  ASSERT_TRUE(result.ok());
  EXPECT_LT(cpu_seconds() - begun, test::kSlowness * 0.5);
  EXPECT_EQ(result->pages.size(), 1u);
}

// Compares the index with a look at every page.
TEST(HeightIndex, NamesTheFirstPageWithRoom) {
  test::Noise noise{41};
  for (int round = 0; round < 40; ++round) {
    std::vector<FreeRects> pages;
    HeightIndex index;
    int height = 20;
    for (int step = 0; step < 120; ++step) {
      height = std::max(1, height - noise.in(0, 3) / 3);
      const Extent item{noise.in(1, 20), height};
      index.sink(height, pages);
      Spot spot;
      std::size_t expected = 0;
      while (expected < pages.size() &&
             !pages[expected].find(item, false, PlaceRule::bottom_left, spot))
        ++expected;
      ASSERT_EQ(index.first(item.width), expected);
      if (expected == pages.size()) {
        pages.emplace_back(Extent{20, 20});
        index.push_back(pages.back());
        ASSERT_TRUE(pages.back().find(item, false, PlaceRule::bottom_left, spot));
      }
      pages[expected].place(spot.rect);
      index.update(expected, pages[expected]);
    }
  }
}

TEST(Bounds, NeverAboveALayoutKnownToExist) {
  // The pages are cut by random guillotine cuts, so their number is the optimum.
  test::Noise noise{6};
  for (int round = 0; round < 100; ++round) {
    std::vector<Extent> items;
    const int pages = noise.in(1, 4);
    for (int p = 0; p < pages; ++p) {
      std::vector<Rect> parts{{0, 0, 40, 30}};
      for (int cut = noise.in(0, 8); cut > 0; --cut) {
        const std::size_t at = std::size_t(noise.in(0, int(parts.size()) - 1));
        Rect &r = parts[at], rest = r;
        if (noise.in(0, 1) && r.width > 1) {
          const int x = noise.in(1, r.width - 1);
          rest = {r.x + x, r.y, r.width - x, r.height};
          r.width = x;
        } else if (r.height > 1) {
          const int y = noise.in(1, r.height - 1);
          rest = {r.x, r.y + y, r.width, r.height - y};
          r.height = y;
        } else {
          continue;
        }
        parts.push_back(rest);
      }
      for (const Rect& r : parts) items.push_back({r.width, r.height});
    }
    Problem problem;
    problem.items = items;
    problem.page = {40, 30};
    for (bool rotate : {false, true}) {
      problem.allow_rotation = rotate;
      EXPECT_LE(page_bound(problem), static_cast<std::uint32_t>(pages));
      EXPECT_LE(height_bound(problem), 30 * pages);
    }
  }
}

}  // namespace
}  // namespace atlas
