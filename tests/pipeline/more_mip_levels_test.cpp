// Room that is left on pages keeps coarser mip levels of neighbours apart, and costs nothing else.
#include "libatlas/pipeline/more_mip_levels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <utility>
#include <vector>

#include "tests/support/shape_view.h"

namespace atlas::test {
namespace {

struct Plates {
  ChartSet charts;
  std::vector<Vec2d> densities;
};

// Squares of one unit.
Plates plates(int count, double texels) {
  Shape shape = grid(4, 4, 1, 1);
  for (int i = 1; i < count; ++i)
    shape = together(shape, moved(grid(4, 4, 1, 1), 1, {0, 2.0 * i, 0}));
  auto charts = make_charts(view_of(shape), {}, {});
  EXPECT_TRUE(charts.ok());
  return {std::move(*charts), std::vector<Vec2d>(std::size_t(count), {texels, texels})};
}

const LayoutOptions kPages = [] {  // for levels 0 to 2
  LayoutOptions options{{.pages = 4, .page_size = 256, .alignment = 4}};
  options.outlines = true;
  return options;
}();

std::int64_t texels_of(const PageLayout& layout) {
  std::int64_t texels = 0;
  for (const Extent& page : layout.pages) texels += page.area();
  return texels;
}

struct Guarded {
  PageLayout narrow, layout;
  int mip_levels = 0;
};

Guarded guarded(const Plates& plates, const LayoutOptions& options = kPages) {
  auto narrow = lay_out_pages(plates.charts, plates.densities, options, {});
  EXPECT_TRUE(narrow.ok());
  auto wide = guard_more_levels({plates.charts, plates.densities}, options, {*narrow, 2}, {});
  EXPECT_TRUE(wide.ok());
  return {*narrow, wide->layout, wide->mip_levels};
}

// Returns the least number of texels between the boxes of two charts on a page, along the axis
// where they are farther apart.
int least_distance(const PageLayout& layout) {
  int least = 1 << 20;
  for (const ChartPlacement& a : layout.placements)
    for (const ChartPlacement& b : layout.placements) {
      if (a.chart >= b.chart || a.page != b.page) continue;
      const int across = std::max(b.x - a.x - a.width, a.x - b.x - b.width);
      const int along = std::max(b.y - a.y - a.height, a.y - b.y - b.height);
      least = std::min(least, std::max(across, along));
    }
  return least;
}

TEST(MoreMipLevels, FillTheRoomThatIsLeft) {
  struct Case {
    double texels;  // a side of each of four plates, two beside each other
    int mip_levels;
  };
  for (const Case& c : {Case{90, 5}, {108, 4}, {120, 3}, {124, 2}}) {
    SCOPED_TRACE(c.texels);
    const Guarded g = guarded(plates(4, c.texels));
    EXPECT_EQ(g.mip_levels, c.mip_levels);
    EXPECT_EQ(g.narrow.scale, 1);
    EXPECT_EQ(g.layout.scale, 1);
    EXPECT_LE(texels_of(g.layout), texels_of(g.narrow));
    EXPECT_GE(least_distance(g.layout), 2 * gutter_pad(c.mip_levels));
    for (const ChartPlacement& p : g.layout.placements) EXPECT_EQ(p.texels_per_unit.x, c.texels);
  }
}

// Eight plates take two pages. Wider gutters would need a third one, which is allowed but not free.
TEST(MoreMipLevels, TakeNoFurtherPages) {
  const Guarded g = guarded(plates(8, 120));
  EXPECT_EQ(g.narrow.pages.size(), 2u);
  EXPECT_EQ(g.layout.pages.size(), 2u);
  EXPECT_EQ(g.mip_levels, 3);
}

TEST(MoreMipLevels, AreNotForPagesThatMakeChartsSmaller) {
  LayoutOptions one = kPages;
  one.pages = 1;
  const Guarded g = guarded(plates(5, 200), one);
  EXPECT_LT(g.narrow.scale, 1);
  EXPECT_EQ(g.mip_levels, 2);
  EXPECT_EQ(g.layout.scale, g.narrow.scale);
}

TEST(MoreMipLevels, CanBeCancelled) {
  const Plates four = plates(4, 90);
  auto narrow = lay_out_pages(four.charts, four.densities, kPages, {});
  ASSERT_TRUE(narrow.ok());
  Context context;
  const std::atomic<bool> cancel = true;
  context.cancel = &cancel;
  const auto wide = guard_more_levels({four.charts, four.densities}, kPages, {*narrow, 2}, context);
  EXPECT_EQ(wide.status().code(), ErrorCode::cancelled);
}

}  // namespace
}  // namespace atlas::test
