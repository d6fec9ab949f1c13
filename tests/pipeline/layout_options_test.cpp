// How large pages are and how long charts may be, against closed forms.
#include "libatlas/pipeline/layout_options.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libatlas/pipeline/longest_sides.h"

namespace atlas::test {
namespace {

// Returns rectangles of one size, which fill their boxes.
ChartSet rectangles(std::size_t count, Vec2d size) {
  ChartSet charts;
  charts.charts.resize(count);
  for (Chart& chart : charts.charts) {
    chart.size = size;
    chart.distortion.uv_area = size.x * size.y;
  }
  return charts;
}

TEST(LayoutOptions, PagesWithImagesFollowTheExportsOptions) {
  ExportOptions options;
  options.atlases = 5;
  options.atlas_size = 512;
  options.packing = PackPreset::fast;
  options.outlines = false;
  options.min_side = 8;
  options.square_plain_page = true;  // is only for pages without images
  for (const auto& [mip_levels, padding, alignment] :
       {std::array{0, 1, 1}, std::array{1, 1, 2}, std::array{4, 8, 16}}) {
    options.mip_levels = mip_levels;
    const LayoutOptions layout = layout_options(rectangles(3, {1, 1}), options, true);
    EXPECT_EQ(layout.pages, 5u);
    EXPECT_EQ(layout.page_size, 512);
    EXPECT_EQ(layout.padding, padding);
    EXPECT_EQ(layout.alignment, alignment);
    EXPECT_EQ(layout.minimum_side, 8);
    EXPECT_EQ(layout.preset, PackPreset::fast);
    EXPECT_FALSE(layout.outlines);
    EXPECT_FALSE(layout.square);
    EXPECT_FALSE(layout.free_aspect);
  }
}

TEST(LayoutOptions, PlainPagesHaveGuttersForTheMipLevelsAskedFor) {
  ExportOptions options;
  options.mip_levels = 5;  // is only for pages with images
  for (const auto& [mip_levels, padding, alignment] :
       {std::array{0, 1, 1}, std::array{1, 1, 2}, std::array{4, 8, 16}}) {
    options.plain_mip_levels = mip_levels;
    const LayoutOptions layout = layout_options(rectangles(3, {1, 1}), options, false);
    EXPECT_EQ(layout.padding, padding);
    EXPECT_EQ(layout.alignment, alignment);
  }
}

TEST(LayoutOptions, PlainPagesAreFreeOnlyIfOneMayHaveAnyShape) {
  ExportOptions options;
  const auto layout = [&](std::uint32_t pages, bool square) {
    options.plain_pages = pages;
    options.square_plain_page = square;
    return layout_options(rectangles(3, {1, 1}), options, false);
  };
  EXPECT_TRUE(layout(1, false).free_aspect);
  EXPECT_FALSE(layout(1, true).free_aspect);
  EXPECT_TRUE(layout(1, true).square);
  EXPECT_TRUE(layout(4, false).square);
  EXPECT_FALSE(layout(4, false).free_aspect);
  EXPECT_EQ(layout(4, false).pages, 4u);
  EXPECT_EQ(layout(4, false).minimum_side, 0);
}

// Each chart shall have 1024 texels on average.
TEST(LayoutOptions, ASinglePlainPageIsDoubledUntilItHasRoom) {
  ExportOptions options;
  options.atlas_size = 64;
  options.square_plain_page = true;
  const auto side = [&](std::size_t charts, Vec2d size = {1, 1}) {
    return layout_options(rectangles(charts, size), options, false).page_size;
  };
  EXPECT_EQ(side(4), 64);
  EXPECT_EQ(side(5), 128);
  EXPECT_EQ(side(16), 128);
  EXPECT_EQ(side(17), 256);
  EXPECT_EQ(side(65537), 16384);
  EXPECT_EQ(side(262145), 16384);
  EXPECT_EQ(side(16, {64, 1}), 128);  // strips are cut for a square page
  options.square_plain_page = false;
  // A page as long as the strips is 16 * 64 / (0.75 * 64 * 64) as wide as long, a third.
  EXPECT_EQ(side(16, {64, 1}), 256);
  options.plain_pages = 2;
  EXPECT_EQ(side(17), 64);
  options.plain_pages = 1;
  options.larger_plain_page = false;
  EXPECT_EQ(side(17), 64);
}

// Returns the limit of one chart on one page of 64 x 64 texels.
double limit(Vec2d size, double density, ExportOptions options) {
  options.atlases = 1;
  options.atlas_size = 64;
  TextureOptions texture;
  texture.max_side = 60;
  const std::vector<double> densities{density};
  return longest_sides(rectangles(1, size), densities, {texture, options})[0];
}

// Boxes take as little as nine texels each, so cutting costs no room.
TEST(LongestSides, AreHalfAPageAtTheLikelyScale) {
  ExportOptions options;
  options.mip_levels = 0;
  options.min_side = 1;
  for (const double threshold : {0.0, 0.01}) {
    options.threshold = threshold;
    EXPECT_DOUBLE_EQ(limit({1, 1}, 10, options), 3) << "half of 60 texels";
    // The chart wants 10 x 100 x 100 texels, of which 4096 are there. Downsizing leaves a quarter.
    const double wanted = threshold > 0 ? 1e5 / 4 : 1e5;
    EXPECT_DOUBLE_EQ(limit({10, 1}, 100, options), 30 / (100 * std::sqrt(4096 / wanted)));
  }
}

// Even the smallest box takes 20 x 20 texels, so half of the page holds five of them.
TEST(LongestSides, AreDoubledUntilTheSmallestBoxesTakeHalfThePages) {
  ExportOptions options;
  options.threshold = 0;
  const double scale = 0.64, half_page = 30 / (10 * scale);
  EXPECT_DOUBLE_EQ(limit({25, 4}, 10, options), 2 * half_page) << "3 boxes instead of 6";
  EXPECT_DOUBLE_EQ(limit({10, 10}, 10, options), 2 * half_page) << "4 boxes instead of 9";
}

// A chart of 10 x 1 units on one page of 64 x 64 texels, 60 without gutters.
TEST(SizingFactor, IsTheLikelyScaleWhereAChartIsLongerThanAPage) {
  ExportOptions options;
  options.atlases = 1;
  options.atlas_size = 64;
  options.threshold = 0;
  TextureOptions texture;
  texture.max_side = 60;
  const auto factor = [&](double density) {
    const std::vector<double> densities{density};
    return sizing_factor(rectangles(1, {10, 1}), densities, {texture, options});
  };
  EXPECT_EQ(factor(6), 1) << "as long as the page";
  EXPECT_EQ(factor(7), 1) << "longer, but the pages hold its texels";
  EXPECT_DOUBLE_EQ(factor(100), std::sqrt(4096 / 1e5));
  TextureResult sized;
  sized.charts.resize(1);
  sized.charts[0].width = sized.charts[0].height = 50;  // more than half of the page with gutters
  EXPECT_EQ(refilled_factor(0.2, sized, {texture, options}), 0.2);
  sized.charts[0].width = 1;
  EXPECT_GT(refilled_factor(0.2, sized, {texture, options}), 0.3);
  EXPECT_EQ(refilled_factor(0.9, sized, {texture, options}), 1);
  EXPECT_EQ(refilled_factor(1, sized, {texture, options}), 1);
  const TextureOptions half = scaled(texture, 0.5);
  EXPECT_DOUBLE_EQ(half.texel, 2 * texture.texel);
  EXPECT_DOUBLE_EQ(half.texture_sampling, 0.5 * texture.texture_sampling);
}

}  // namespace
}  // namespace atlas::test
