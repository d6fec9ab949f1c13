// No trilinear look-up in a chart reads another chart's texels. Checked with charts of one colour
// each and a mip chain made as graphics drivers make it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <string_view>

#include "tests/bake/bake_fixture.h"

namespace atlas {
namespace {

ImageF halve(const ImageF& in) {
  ImageF out(in.width / 2, in.height / 2, in.channels);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      for (int k = 0; k < in.channels; ++k)
        out.at(x, y)[k] = 0.25f * (in.at(2 * x, 2 * y)[k] + in.at(2 * x + 1, 2 * y)[k] +
                                   in.at(2 * x, 2 * y + 1)[k] + in.at(2 * x + 1, 2 * y + 1)[k]);
  return out;
}

// Places charts of random sizes in boxes aligned to 2^levels, in rows, with no space between boxes.
LitShape tiled(int levels, int page, std::vector<ChartPlacement>& placements) {
  LitShape shape;
  std::mt19937 random(17);
  const int align = 1 << levels, pad = gutter_pad(levels);
  const auto up = [&](int n) { return (n + align - 1) / align * align; };
  int x = 0, y = 0, shelf = 0;
  for (std::uint32_t i = 0;; ++i) {
    const double w = 0.02 + (random() % 400) / 1000.0, h = 0.02 + (random() % 300) / 1000.0;
    // The colours differ clearly from those of neighbours and from black.
    const float red = srgb_decode(0.2f + 0.1f * static_cast<float>(i % 8));
    const float green = srgb_decode(0.2f + 0.1f * static_cast<float>(i / 8 % 8));
    const LitShape sheet = make_sheet({w, h, 2 + int(i % 5), 2, 0.2}, [&](double, double) {
      return Vec3f{red, green, 1};
    });
    LitShape trial = shape;
    append(trial, sheet, {0, 0, static_cast<float>(i)});
    ChartPlacement p = place(trial.charts, i, {97, 97}, {0, 0, i % 2 == 1});
    const int bw = up(p.width + 2 * pad), bh = up(p.height + 2 * pad);
    if (x + bw > page) x = 0, y += shelf, shelf = 0;
    if (y + bh > page) return shape;
    p = place(trial.charts, i, {97, 97}, {x + pad, y + pad, i % 2 == 1});
    placements.push_back(p);
    shape = trial;
    x += bw;
    shelf = std::max(shelf, bh);
  }
}

TEST(Gutter, NoLookUpSeesANeighbourAtAnyPromisedLevel) {
  for (const BakeMethod method : {BakeMethod::least_squares, BakeMethod::average})
    for (int levels = 0; levels <= 4; ++levels) {
      std::vector<ChartPlacement> placements;
      const LitShape shape = tiled(levels, 256, placements);
      ASSERT_GT(placements.size(), levels == 4 ? 8u : 20u);
      BakeOptions options = small_page(256, method);
      options.mip_levels = levels;
      const auto page = bake(shape, placements, options);
      ASSERT_TRUE(page.ok()) << page.status().message();
      ImageF mip(256, 256, 3);
      for (std::size_t i = 0; i < mip.texels.size(); ++i) mip.texels[i] = page->display.texels[i];
      std::mt19937 random(1);
      for (int level = 0; level <= levels; ++level) {
        if (level > 0) mip = halve(mip);
        for (const ChartPlacement& p : placements) {
          const Vec3f e = shape.scene.illumination[shape.charts.charts[p.chart].first_uv];
          const Vec3f want = kPlain.display(e);
          for (int n = 0; n < 60; ++n) {
            // Tests points anywhere in the inner box, its corners first.
            const double s = n < 4 ? n % 2 : (random() % 1001) / 1000.0;
            const double t = n < 4 ? n / 2 : (random() % 1001) / 1000.0;
            const double scale = std::ldexp(1.0, -level);
            const Vec2d at{(p.x + s * p.width) * scale, (p.y + t * p.height) * scale};
            ASSERT_NEAR(look_up(mip, at, 0), 255 * want.x, 0.51) << levels << ' ' << level;
            ASSERT_NEAR(look_up(mip, at, 1), 255 * want.y, 0.51) << levels << ' ' << level;
          }
        }
      }
    }
}

// Two slanted strips whose boxes overlap, placed as the outline packer does.
TEST(Gutter, OutlinedChartsKeepToTheirCells) {
  LitShape shape = make_sheet({1, 0.1, 9, 2}, [](double, double) { return shown(0.4); });
  append(shape, make_sheet({1, 0.1, 9, 2}, [](double, double) { return shown(0.9); }), {0, 0, 1});
  std::vector<ChartPlacement> placements;
  for (std::uint32_t i = 0; i < 2; ++i) {
    ChartPlacement p;
    p.chart = i;
    p.page = 0;
    p.outlined = true;
    p.cosine = p.sine = std::sqrt(0.5);
    p.texels_per_unit = {64, 64};
    p.offset = {16.3 + 28 * i, 10.9};
    p.x = 8 + 2 + 28 * static_cast<int>(i);
    p.y = 8 + 2;
    p.width = p.height = 60 - 4;
    placements.push_back(p);
  }
  for (const bool swapped : {false, true}) {
    if (swapped) std::swap(placements[0], placements[1]);
    const auto page = bake(shape, placements, small_page(128));
    ASSERT_TRUE(page.ok()) << page.status().message();
    ImageF mip(128, 128, 3);
    for (std::size_t i = 0; i < mip.texels.size(); ++i) mip.texels[i] = page->display.texels[i];
    for (int level = 0; level <= 2; ++level) {
      if (level > 0) mip = halve(mip);
      for (const ChartPlacement& p : placements)
        for (int n = 0; n <= 400; ++n) {
          const Vec2d uv{(n % 101) / 100.0, 0.1 * (n / 101) / 3.0};
          const Vec2d at = page_texel(p, uv);
          const double scale = std::ldexp(1.0, -level);
          ASSERT_NEAR(look_up(mip, {at.x * scale, at.y * scale}, 0), p.chart ? 229.5 : 102, 0.51)
              << level << ' ' << n;
        }
    }
  }
}

// Charts of one colour each that are closer than their gutters are wide: two texels lie between
// them, although mip levels ask for four or more.
LitShape crowded(bool outlined, std::vector<ChartPlacement>& placements) {
  LitShape shape;
  std::mt19937 random(23);
  for (std::uint32_t i = 0; i < 64; ++i) {
    const double red = 0.15 + 0.1 * (i % 8), green = 0.15 + 0.1 * (i / 8);
    append(shape,
           make_sheet({0.2, 0.2, 3, 3},
                      [&](double, double) {
                        return Vec3f{srgb_decode(float(red)), srgb_decode(float(green)), 1};
                      }),
           {0, 0, float(i)});
    ChartPlacement p = place(shape.charts, i, {79.9, 79.9}, {4, 4});
    EXPECT_EQ(p.width, 16);  // the box is nearly full, so rounding reaches no further texel
    p.x += 18 * static_cast<int>(i % 8);
    p.y += 18 * static_cast<int>(i / 8);
    turn_in_box(p, random() % 2);
    p.outlined = outlined;
    placements.push_back(p);
  }
  return shape;
}

TEST(Gutter, ChartsTooNearToEachOtherAreTheSameForAnyThreadsAndOrder) {
  for (const bool outlined : {false, true}) {
    for (const int levels : {0, 2, 3}) {
      std::vector<ChartPlacement> placements;
      const LitShape shape = crowded(outlined, placements);
      BakeOptions options = small_page(160);
      options.mip_levels = levels;
      options.linear = true;
      if (levels == 3) {
        for (ChartPlacement& p : placements) p.x += 2, p.offset.x += 2;  // off the cells' corners
      }
      const auto one = bake(shape, placements, options, 1);
      ASSERT_TRUE(one.ok()) << one.status().message();
      EXPECT_EQ(one->contested_texels > 0, levels > 0) << outlined << ' ' << levels;
      for (int repeat = 0; repeat < 10; ++repeat) {
        std::shuffle(placements.begin(), placements.end(), std::mt19937(repeat));
        const auto four = bake(shape, placements, options, 4);
        ASSERT_TRUE(four.ok());
        ASSERT_EQ(one->display.texels, four->display.texels) << outlined << ' ' << levels;
        ASSERT_EQ(one->linear.texels, four->linear.texels) << outlined << ' ' << levels;
        ASSERT_EQ(one->contested_texels, four->contested_texels);
      }
      // Look-ups at level 0 read only their own chart, including at borders.
      for (const ChartPlacement& p : placements) {
        const Vec3f want =
            kPlain.display(shape.scene.illumination[shape.charts.charts[p.chart].first_uv]);
        for (int n = 0; n < 81; ++n) {
          const Vec2d at = page_texel(p, {0.2 * (n % 9) / 8, 0.2 * (n / 9) / 8});
          ASSERT_NEAR(look_up(one->display, at, 0), 255 * want.x, 0.51) << outlined << levels;
          ASSERT_NEAR(look_up(one->display, at, 1), 255 * want.y, 0.51) << outlined << levels;
        }
      }
    }
  }
}

// Contested texels are counted independently from rectangles. The warning names two of the charts.
TEST(Gutter, ContestedTexelsAreCountedAndTold) {
  std::vector<ChartPlacement> placements;
  const LitShape shape = crowded(false, placements);
  BakeOptions options = small_page(160);
  options.mip_levels = 2;
  std::vector<int> claims(160 * 160, 0);
  for (const ChartPlacement& p : placements) {
    const auto end = [](int begin, int length) {  // of a box that grows to whole cells
      return begin % 4 == 0 ? (begin + length + 3) / 4 * 4 : begin + length;
    };
    for (int y = p.y - 2; y < end(p.y - 2, p.height + 4); ++y)
      for (int x = p.x - 2; x < end(p.x - 2, p.width + 4); ++x) ++claims[y * 160 + x];
  }
  const auto several =
      std::count_if(claims.begin(), claims.end(), [](int count) { return count > 1; });
  const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
  std::vector<std::string> lines;
  Context context;
  context.warn = [&](std::string_view line) { lines.emplace_back(line); };
  const auto page = bake_page({sampler, shape.charts, kPlain}, placements, options, context);
  ASSERT_TRUE(page.ok());
  EXPECT_EQ(page->contested_texels, std::uint64_t(several));
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find("to 0 and 1:"), std::string::npos) << lines[0];
  EXPECT_NE(lines[0].find("padding of 2 and an alignment of 4"), std::string::npos) << lines[0];
  // If there is space for the gutters, nothing is contested and there is no warning.
  for (ChartPlacement& p : placements) {
    p.x = 2 + 20 * (p.x - 4) / 18;
    p.y = 2 + 20 * (p.y - 4) / 18;
    turn_in_box(p, false);
  }
  options.page_width = options.page_height = 176;
  const auto roomy = bake_page({sampler, shape.charts, kPlain}, placements, options, context);
  ASSERT_TRUE(roomy.ok());
  EXPECT_EQ(roomy->contested_texels, 0u);
  EXPECT_EQ(lines.size(), 1u);
}

// Charts beside the contested texels, in the same rows, are not named.
TEST(Gutter, TheWarningNamesTheChartsThatClaimTheTexel) {
  std::vector<ChartPlacement> placements;
  const LitShape shape = crowded(false, placements);
  placements.resize(7);
  for (int i = 0; i < 7; ++i) placements[i].x = 4 + 22 * i - (i > 4 ? 6 : 0);
  for (ChartPlacement& p : placements) turn_in_box(p, false);
  const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
  BakeOptions options = small_page(160);
  options.mip_levels = 2;
  std::vector<std::string> lines;
  Context context;
  context.warn = [&](std::string_view line) { lines.emplace_back(line); };
  ASSERT_TRUE(bake_page({sampler, shape.charts, kPlain}, placements, options, context).ok());
  ASSERT_EQ(lines.size(), 1u);
  // Chart 5 begins 16 texels after chart 4, whose box of 16 has gutters of 2 on both sides.
  EXPECT_NE(lines[0].find("the first at (106, 2) to 4 and 5:"), std::string::npos) << lines[0];
}

TEST(Gutter, BoxesKeepWithinThemselves) {
  std::vector<ChartPlacement> placements;
  const LitShape shape = tiled(2, 256, placements);
  BakeOptions options = small_page(256);
  options.linear = true;
  const auto all = bake(shape, placements, options);
  ASSERT_TRUE(all.ok());
  // Without one chart the boxes of the others are the same, and nothing is baked into its box.
  const ChartPlacement gone = placements[5];
  placements.erase(placements.begin() + 5);
  const auto rest = bake(shape, placements, options);
  ASSERT_TRUE(rest.ok());
  const auto up = [](int n) { return (n + 3) / 4 * 4; };
  const int pad = gutter_pad(2);
  const auto for_box = [&](const ChartPlacement& p, const auto& visit) {
    for (int y = p.y - pad; y < up(p.y + p.height + pad); ++y)
      for (int x = p.x - pad; x < up(p.x + p.width + pad); ++x) visit(x, y);
  };
  for (const ChartPlacement& p : placements)
    for_box(p, [&](int x, int y) {
      ASSERT_EQ(rest->display.at(x, y)[2], all->display.at(x, y)[2]);
      ASSERT_EQ(rest->linear.at(x, y)[2], all->linear.at(x, y)[2]);
    });
  for_box(gone, [&](int x, int y) { ASSERT_EQ(rest->linear.at(x, y)[2], 0); });
}

TEST(Gutter, TexelsOfNoChartTakeTheColoursAroundThem) {
  std::vector<ChartPlacement> placements;
  const LitShape shape = tiled(2, 256, placements);
  const auto page = bake(shape, placements, small_page(256));
  ASSERT_TRUE(page.ok());
  // Every chart has blue light, so no texel of the page may stay black in that channel.
  std::size_t black = 0;
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 256; ++x) black += page->display.at(x, y)[2] == 0;
  EXPECT_EQ(black, 0u);
}

}  // namespace
}  // namespace atlas
