// The engines below the public functions: holes are found again, bounds hold.
#include <gtest/gtest.h>

#include <algorithm>

#include "libatlas/pack/engines.h"
#include "libatlas/pack/skyline.h"
#include "tests/pack/checks.h"

namespace atlas {
namespace {

using namespace pack;

// The maximal free rectangles against all rectangles of a small grid.
TEST(FreeRects, HoldExactlyTheMaximalRectangles) {
  test::Noise noise{4};
  for (int round = 0; round < 200; ++round) {
    constexpr int n = 9;
    FreeRects page({n, n});
    bool taken[n][n] = {};
    for (int k = noise.in(1, 6); k > 0; --k) {
      const int x = noise.in(0, n - 1), y = noise.in(0, n - 1);
      const Rect r{x, y, noise.in(1, n - x), noise.in(1, n - y)};
      page.place(r);
      for (int yy = r.y; yy < r.top(); ++yy)
        for (int xx = r.x; xx < r.right(); ++xx) taken[yy][xx] = true;
    }
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
  EXPECT_EQ(put({8, 4}), (Rect{0, 6, 8, 4}));  // buries 4 x 4 above the second
  EXPECT_EQ(put({4, 4}), (Rect{4, 2, 4, 4}));
}

TEST(Bounds, NeverAboveALayoutKnownToExist) {
  // Pages cut by random guillotines: the number of pages is the optimum.
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
