// Uvs of placed charts, as fractions of their pages.
#include "libatlas/uvs/page_uvs.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace atlas {
namespace {

// Two charts on pages of different shapes, the second one turned by a right angle. Texels are
// counted by hand.
TEST(PageUvs, AreSharesOfTheSidesOfTheirOwnPage) {
  ChartSet set;
  set.uvs = {{0, 0}, {3, 0}, {0, 2}, {0, 0}, {3, 2}};
  set.charts.resize(2);
  set.charts[0].uv_count = 3;
  set.charts[1].first_uv = 3;
  set.charts[1].uv_count = 2;
  std::vector<ChartPlacement> placements(2);
  placements[0].chart = 1;
  placements[0].page = 0;
  placements[0].texels_per_unit = {10, 20};
  placements[0].cosine = 0;
  placements[0].sine = 1;
  placements[0].offset = {50, 8};
  placements[1].chart = 0;
  placements[1].page = 1;
  placements[1].texels_per_unit = {4, 4};
  placements[1].offset = {1, 2};
  const std::array<Extent, 2> pages{Extent{64, 128}, Extent{16, 32}};
  const std::vector<Vec2d> uvs = page_uvs({set, placements, pages});
  const Vec2d texels[] = {{1, 2}, {13, 2}, {1, 10}, {50, 8}, {50 - 40, 8 + 30}};
  ASSERT_EQ(uvs.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    const Extent page = pages[i < 3 ? 1 : 0];
    EXPECT_DOUBLE_EQ(uvs[i].x, texels[i].x / page.width) << i;
    EXPECT_DOUBLE_EQ(uvs[i].y, texels[i].y / page.height) << i;
  }
}

}  // namespace
}  // namespace atlas
