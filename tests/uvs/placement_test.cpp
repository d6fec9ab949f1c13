#include "libatlas/uvs/placement.h"

#include <gtest/gtest.h>

namespace atlas {
namespace {

TEST(Placement, MapsTheChartsBoxOntoItsInnerBox) {
  ChartPlacement p;
  p.x = 10;
  p.y = 20;
  p.width = 40;
  p.height = 8;
  p.texels_per_unit = {4, 2};
  turn_in_box(p, false);
  EXPECT_EQ(page_texel(p, {0, 0}), (Vec2d{10, 20}));
  EXPECT_EQ(page_texel(p, {10, 4}), (Vec2d{50, 28}));
  // After a quarter turn counter-clockwise, u points up and v points to the left.
  p.width = 8;
  p.height = 40;
  turn_in_box(p, true);
  EXPECT_EQ(page_texel(p, {0, 0}), (Vec2d{18, 20}));
  EXPECT_EQ(page_texel(p, {10, 0}), (Vec2d{18, 60}));
  EXPECT_EQ(page_texel(p, {0, 4}), (Vec2d{10, 20}));
}

TEST(Placement, NeverMirrors) {
  for (const bool rotated : {false, true}) {
    ChartPlacement p;
    p.width = p.height = 100;
    turn_in_box(p, rotated);
    p.texels_per_unit = {3, 5};
    const Vec2d o = page_texel(p, {1, 1}), u = page_texel(p, {2, 1}), v = page_texel(p, {1, 2});
    EXPECT_EQ((u.x - o.x) * (v.y - o.y) - (u.y - o.y) * (v.x - o.x), 15);
  }
}

TEST(Placement, IsUndone) {
  ChartPlacement p;
  p.offset = {40, -7};
  p.cosine = 0.6;
  p.sine = -0.8;
  p.texels_per_unit = {4, 4};
  const Vec2d uv = chart_uv(p, page_texel(p, {2.5, -1.25}));
  EXPECT_NEAR(uv.x, 2.5, 1e-12);
  EXPECT_NEAR(uv.y, -1.25, 1e-12);
  p.width = 8;
  p.texels_per_unit = {3, 5};
  turn_in_box(p, true);
  EXPECT_EQ(chart_uv(p, page_texel(p, {2, 7})), (Vec2d{2, 7}));
}

TEST(Placement, PadsByHalfATexelOfTheCoarsestLevel) {
  EXPECT_EQ(gutter_pad(0), 1);
  EXPECT_EQ(gutter_pad(1), 1);
  EXPECT_EQ(gutter_pad(2), 2);
  EXPECT_EQ(gutter_pad(5), 16);
}

}  // namespace
}  // namespace atlas
