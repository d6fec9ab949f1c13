#include <gtest/gtest.h>

#include <random>

#include "libatlas/raster/texel_grid.h"

namespace atlas {
namespace {

TEST(FillUnknown, KeepsWhatIsKnownAndStaysBetweenItsExtremes) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 60; ++trial) {
    TexelGrid grid(1 + static_cast<int>(random() % 70), 1 + static_cast<int>(random() % 70));
    const unsigned rarity = 1 + random() % 200;
    for (std::size_t i = 0; i < grid.rgb.size(); ++i) {
      if (random() % rarity) continue;
      grid.known[i] = 1;
      grid.rgb[i] = Lanes{0.25f + 0.001f * static_cast<float>(random() % 500), 0.5f, 1, 1};
    }
    const TexelGrid before = grid;
    const std::size_t filled = fill_unknown(grid);
    std::size_t unknown = 0;
    for (std::size_t i = 0; i < grid.rgb.size(); ++i) unknown += !before.known[i];
    EXPECT_EQ(filled, unknown);
    for (std::size_t i = 0; i < grid.rgb.size(); ++i) {
      if (before.known[i]) {
        ASSERT_EQ(grid.rgb[i][0], before.rgb[i][0]);
      }
      if (unknown == grid.rgb.size()) {
        ASSERT_EQ(grid.rgb[i][1], 0);  // no texel is known
        continue;
      }
      ASSERT_NEAR(grid.rgb[i][1], 0.5f, 1e-5);
      ASSERT_GE(grid.rgb[i][0], 0.25f - 1e-5f);
      ASSERT_LE(grid.rgb[i][0], 0.75f + 1e-5f);
    }
  }
}

// No direction is preferred: filling a mirrored grid gives the mirror image. Sides are powers of
// two, so that levels are halved equally from both ends.
TEST(FillUnknown, MirrorsWhatIsMirrored) {
  std::mt19937 random(4);
  constexpr int w = 64, h = 32;
  for (int trial = 0; trial < 8; ++trial) {
    TexelGrid grid(w, h), across(w, h), turned(h, w);
    for (int k = 0; k < 40; ++k) {
      const int x = int(random() % w), y = int(random() % h);
      const Lanes value = splat_lanes(static_cast<float>(random() % 100) / 100);
      const auto put = [&](TexelGrid& to, int i, int j) {
        to.known[std::size_t(j) * to.width + i] = 1;
        to.rgb[std::size_t(j) * to.width + i] = value;
      };
      put(grid, x, y);
      put(across, w - 1 - x, h - 1 - y);
      put(turned, y, x);
    }
    for (TexelGrid* g : {&grid, &across, &turned}) fill_unknown(*g);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const float v = grid.rgb[std::size_t(y) * w + x][0];
        ASSERT_NEAR(v, across.rgb[std::size_t(h - 1 - y) * w + (w - 1 - x)][0], 1e-5);
        ASSERT_NEAR(v, turned.rgb[std::size_t(x) * h + y][0], 1e-5);
      }
  }
}

TEST(FillUnknown, GoesSmoothlyFromOneSideToTheOther) {
  TexelGrid grid(64, 8);
  for (int y = 0; y < 8; ++y)
    for (const int x : {0, 63}) {
      grid.known[std::size_t(y) * 64 + x] = 1;
      grid.rgb[std::size_t(y) * 64 + x] = splat_lanes(x ? 1.0f : 0.0f);
    }
  fill_unknown(grid);
  for (int y = 0; y < 8; ++y)
    for (int x = 1; x < 64; ++x) {
      const float a = grid.rgb[std::size_t(y) * 64 + x - 1][0];
      const float b = grid.rgb[std::size_t(y) * 64 + x][0];
      EXPECT_GE(b, a - 1e-5f);
      EXPECT_LT(b - a, 0.15f);
    }
}

TEST(FillUnknown, OfAPageIsThatOfItsGrid) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 300; ++trial) {
    const int width = 1 + static_cast<int>(random() % 20),
              height = 1 + static_cast<int>(random() % 9);
    Image8 page(width, height, 3);
    TexelGrid grid(width, height);
    std::vector<std::uint8_t> known(grid.known.size());
    const unsigned share = trial % 11;  // none at first, all at last
    for (std::size_t i = 0; i < known.size(); ++i) {
      known[i] = grid.known[i] = random() % 10 < share;
      if (!known[i]) continue;
      for (int k = 0; k < 3; ++k) {
        page.texels[3 * i + k] = static_cast<std::uint8_t>(random());
        grid.rgb[i][k] = static_cast<float>(page.texels[3 * i + k]) / 255;
      }
    }
    fill_unknown(known, page);
    fill_unknown(grid);
    for (std::size_t i = 0; i < known.size(); ++i)
      for (int k = 0; k < 3; ++k) ASSERT_EQ(page.texels[3 * i + k], quantize8(grid.rgb[i][k]));
  }
}

}  // namespace
}  // namespace atlas
