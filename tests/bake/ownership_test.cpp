// The texels that a chart owns, and their distances from its triangles, compared with the
// definitions.
#include "libatlas/bake/ownership.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <vector>

namespace atlas {
namespace {

std::vector<TexelTriangle> few_triangles(std::mt19937& random, const OwnershipGrid& grid) {
  std::vector<TexelTriangle> triangles(random() % 4);
  for (TexelTriangle& triangle : triangles) {
    const Vec2d at{double(random() % unsigned(grid.width)),
                   double(random() % unsigned(grid.height))};
    for (Vec2d& corner : triangle)
      corner = {at.x + (random() % 1000) / 200.0, at.y + (random() % 1000) / 200.0};
  }
  return triangles;
}

// Returns the distance along rows or columns, whichever is more, to the nearest set texel.
int nearest_set(const std::vector<std::uint8_t>& set, const OwnershipGrid& grid, int x, int y) {
  int least = 65535;
  for (int j = 0; j < grid.height; ++j)
    for (int i = 0; i < grid.width; ++i)
      if (set[std::size_t(j * grid.width + i)])
        least = std::min(least, std::max(std::abs(i - x), std::abs(j - y)));
  return least;
}

TEST(Ownership, ReachesAsFarAsThePadAndFillsCells) {
  std::mt19937 random(6);
  for (int trial = 0; trial < 200; ++trial) {
    OwnershipGrid grid;
    grid.width = 1 + int(random() % 30);
    grid.height = 1 + int(random() % 30);
    const std::vector<TexelTriangle> triangles = few_triangles(random, grid);
    grid.pad = 0;
    const std::vector<std::uint8_t> touched = owned_texels(triangles, grid);
    const std::vector<std::uint16_t> distance = texels_to_triangles(triangles, grid);
    std::vector<int> want;
    for (int y = 0; y < grid.height; ++y)
      for (int x = 0; x < grid.width; ++x) want.push_back(nearest_set(touched, grid, x, y));
    ASSERT_TRUE(std::equal(distance.begin(), distance.end(), want.begin(), want.end())) << trial;

    grid.pad = int(random() % 4);
    grid.cell = 1 << random() % 4;
    const std::vector<std::uint8_t> owned = owned_texels(triangles, grid);
    for (int y = 0; y < grid.height; ++y)
      for (int x = 0; x < grid.width; ++x) {
        const int left = x - x % grid.cell, low = y - y % grid.cell;
        bool within = false;
        for (int j = low; j < std::min(low + grid.cell, grid.height); ++j)
          for (int i = left; i < std::min(left + grid.cell, grid.width); ++i)
            within = within || want[std::size_t(j * grid.width + i)] <= grid.pad;
        ASSERT_EQ(owned[std::size_t(y * grid.width + x)] != 0, within) << trial;
      }
  }
}

// Charts end exactly where a cell ends. The packer gives the next cell to another chart.
TEST(Ownership, RoundingClaimsNoCellMore) {
  const OwnershipGrid grid{48, 48, 8, 16};
  for (const double error : {-1e-13, 0.0, 1e-13}) {
    const double end = 24 + error;
    const std::vector<TexelTriangle> triangles = {{{{8, 8}, {end, 8}, {end, end}}}};
    const std::vector<std::uint8_t> owned = owned_texels(triangles, grid);
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 48; ++x)
        EXPECT_EQ(owned[std::size_t(y * 48 + x)] != 0, x < 32 && y < 32) << x << ' ' << y;
  }
}

// However narrow a chart is, it owns what it touches.
TEST(Ownership, SliversOwnTheirTexels) {
  const OwnershipGrid grid{48, 16, 0, 1};
  for (const double width : {1e-3, 1e-7, 1e-10}) {
    const std::vector<TexelTriangle> triangles = {{{{8.5, 8.5}, {40.5, 8.5}, {8.5, 8.5 + width}}}};
    const std::vector<std::uint8_t> owned = owned_texels(triangles, grid);
    for (int x = 0; x < 48; ++x)
      EXPECT_EQ(owned[std::size_t(8 * 48 + x)] != 0, x >= 8 && x <= 40) << width << ' ' << x;
  }
}

}  // namespace
}  // namespace atlas
