// Parts of one chart that would share texels: what a viewer sees at their borders.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libatlas/bake/bake.h"
#include "libatlas/core/srgb.h"
#include "libatlas/pipeline/texture_gaps.h"
#include "libatlas/scene/check_scene.h"
#include "libatlas/texture/chart_textures.h"
#include "libatlas/unwrap/page_layout.h"
#include "libatlas/unwrap/part_gaps.h"
#include "tests/support/shapes.h"

namespace atlas::test {
namespace {

constexpr int kColumns = 60, kRows = 6, kPage = 128;
constexpr double kDensity = 20;  // texels per unit: the ends are two thirds of a texel apart

float light_of(double height) {
  return srgb_decode(static_cast<float>(0.2 + 0.6 * height));
}

// A turn of a spiral stair that is brighter the higher it is. Laid flat it is a ring whose dark and
// bright ends nearly meet.
struct Stair {
  Scene scene;
  MeshView view;
  ChartSet charts;

  Stair() {
    const Shape strip = grid(kColumns, kRows);
    for (const Vec3f& p : strip.positions) {
      const double angle = 6.25 * p.x, r = 1.4 - 0.4 * p.y;
      const double x = r * std::cos(angle), y = r * std::sin(angle);
      scene.positions.push_back({float(x), float(y), p.x});
      scene.texcoords.push_back({float((x + 2) / 4), float((y + 2) / 4)});
      const float light = light_of(p.x);
      scene.illumination.push_back({light, light, light});
    }
    scene.indices = scene.texcoord_indices = strip.indices;
    EXPECT_TRUE(complete_scene(scene).ok());
    view.positions = scene.positions;
    view.indices = scene.indices;
    view.texcoords = scene.texcoords;
    view.texcoord_indices = scene.texcoord_indices;
    ChartOptions options;
    options.keep_uv_charts = true;
    auto made = make_charts(view, options, {});
    EXPECT_TRUE(made.ok()) << made.status().message();
    charts = std::move(*made);
    EXPECT_EQ(charts.charts.size(), 1u);
    charts.charts[0].kept = false;
  }

  PagesOfCharts pages() const { return {view, 1.25, double(kPage) * kPage}; }
};

double look_up(const Image8& page, Vec2d at) {
  const double x = at.x - 0.5, y = at.y - 0.5;
  const int i = int(std::floor(x)), j = int(std::floor(y));
  const double s = x - i, t = y - j;
  return (1 - t) * ((1 - s) * page.at(i, j)[0] + s * page.at(i + 1, j)[0]) +
         t * ((1 - s) * page.at(i, j + 1)[0] + s * page.at(i + 1, j + 1)[0]);
}

// Returns the largest error of a look-up at the ends, in 8-bit codes.
double error_at_ends(const Stair& stair) {
  LayoutOptions options;
  options.alignment = 4;
  options.pages = 1;
  options.page_size = kPage;
  const std::vector<Vec2d> density{{kDensity, kDensity}};
  const auto layout = lay_out_pages(stair.charts, density, options, {});
  EXPECT_TRUE(layout.ok());
  EXPECT_EQ(layout->scale, 1);
  const ToneMapping tone;
  const LuminanceSampler sampler(stair.scene, Quantity::luminance);
  BakeOptions bake;
  bake.page_width = layout->pages[0].width;
  bake.page_height = layout->pages[0].height;
  const auto page = bake_page({sampler, stair.charts, tone}, layout->placements, bake, {});
  EXPECT_TRUE(page.ok());
  double worst = 0;
  for (std::size_t i = 0; i < stair.charts.uvs.size(); ++i) {
    const float height = stair.scene.positions[stair.charts.uv_vertex[i]].z;
    if (height > 0 && height < 1) continue;
    const Vec2d at = page_texel(layout->placements[0], stair.charts.uvs[i]);
    worst = std::max(worst, std::abs(look_up(page->display, at) - 255 * (0.2 + 0.6 * height)));
  }
  return worst;
}

TEST(PartGaps, OpenedPartsDoNotBleed) {
  Stair stair;
  const double before = error_at_ends(stair);
  EXPECT_GT(before, 40);
  const std::vector<Vec2d> density{{kDensity, kDensity}};
  EXPECT_EQ(open_part_gaps(stair.pages(), density, stair.charts, {}).charts, 1u);
  EXPECT_LT(error_at_ends(stair), 0.1 * before);
}

TEST(PartGaps, WhatIsLeftIsMeasuredAsPlaced) {
  const Stair stair;
  ChartPlacement placement;
  placement.texels_per_unit = {kDensity, kDensity};
  const GapReport near = left_part_gaps(stair.view, stair.charts, {&placement, 1}, {});
  EXPECT_NEAR(near.near_after, 2 * 0.4 * kDensity, 9) << "both ends, corners included";
  placement.texels_per_unit = {8 * kDensity, 8 * kDensity};
  EXPECT_EQ(left_part_gaps(stair.view, stair.charts, {&placement, 1}, {}).near_after, 0);
}

TEST(PartGaps, OneColourStaysAndNoChartOutgrowsItsPage) {
  Stair stair;
  std::vector<ChartTexture> textures(1);
  textures[0].texels_per_unit = {kDensity, kDensity};
  textures[0].content = ChartContent::uniform;
  EXPECT_EQ(open_texture_gaps(stair.pages(), {textures, kPage}, stair.charts, {}).charts, 0u);
  textures[0].content = ChartContent::varied;
  const int max_side = int(stair.charts.charts[0].size.x * kDensity) - 1;
  EXPECT_EQ(open_texture_gaps(stair.pages(), {textures, max_side}, stair.charts, {}).charts, 1u);
  EXPECT_LE(stair.charts.charts[0].size.x * textures[0].texels_per_unit.x, max_side * (1 + 1e-12));
  EXPECT_GT(textures[0].texels_per_unit.x, 0.9 * kDensity);
  EXPECT_EQ(textures[0].texels_per_unit.x, textures[0].texels_per_unit.y);
}

TEST(PartGaps, TheCoarserDensityDecides) {
  const Stair stair;
  const auto near = [&](Vec2d density) {
    ChartPlacement placement;
    placement.texels_per_unit = density;
    return left_part_gaps(stair.view, stair.charts, {&placement, 1}, {}).near_after;
  };
  EXPECT_GT(near({kDensity, kDensity}), 0);
  EXPECT_EQ(near({kDensity, 8 * kDensity}), near({kDensity, kDensity}));
  EXPECT_EQ(near({8 * kDensity, kDensity}), near({kDensity, kDensity}));
}

// Charts that want more texels than the pages hold become smaller, and so do their gaps.
TEST(PartGaps, AreOpenedForTheLikelyScale) {
  const std::vector<Vec2d> fine{{8 * kDensity, 8 * kDensity}};
  Stair roomy, tight;
  PagesOfCharts pages = roomy.pages();
  pages.texels = 1e9;
  EXPECT_EQ(open_part_gaps(pages, fine, roomy.charts, {}).charts, 0u);
  pages = tight.pages();
  // The ring takes about three square units, and pages are filled to three fifths.
  pages.texels = 3 * kDensity * kDensity / 0.6;
  EXPECT_EQ(open_part_gaps(pages, fine, tight.charts, {}).charts, 1u);
}

// A page that a long strip leaves all but empty has smaller charts than full pages have, so gaps
// that were opened for a full page are too narrow. They are opened again.
TEST(PartGaps, OnPoorPagesTheyAreOpenedOnceMore) {
  Shape shape = grid(kColumns, kRows);
  for (Vec3f& p : shape.positions) {
    const double angle = 6.25 * p.x, r = 1.4 - 0.4 * p.y;
    p = {float(r * std::cos(angle)), float(r * std::sin(angle)), p.x};
  }
  shape = together(shape, moved(grid(100, 1, 12, 0.02), 1, {0, 5, 0}));
  std::vector<Vec2f> from_above;
  for (const Vec3f& p : shape.positions) from_above.push_back({p.x / 16, p.y / 16});
  MeshView mesh;
  mesh.positions = shape.positions;
  mesh.indices = mesh.texcoord_indices = shape.indices;
  mesh.texcoords = from_above;
  ChartOptions options;
  options.keep_uv_charts = true;
  auto made = make_charts(mesh, options, {});
  ASSERT_TRUE(made.ok()) << made.status().message();
  ASSERT_EQ(made->charts.size(), 2u);
  for (Chart& chart : made->charts) chart.kept = false;
  LayoutOptions layout{{.pages = 1, .page_size = 256, .padding = 1, .alignment = 1}};
  layout.minimum_side = 0;
  layout.outlines = layout.square = true;
  const double texels = 256.0 * 256;
  const PlainUvs uvs{mesh, options, filling_density(*made, texels)};
  ChartSet once = *made, twice = *made;
  const std::vector<Vec2d> density(2, {uvs.density, uvs.density});
  open_part_gaps({mesh, options.max_stretch, texels}, density, once, {});
  const auto page = fill_pages(uvs, layout, once, {});
  ASSERT_TRUE(page.ok()) << page.status().message();
  const double near = left_part_gaps(mesh, once, page->placements, {}).near_after;
  ASSERT_GT(near, 1) << "the test is too easy";
  const auto pages = fill_pages_apart(uvs, layout, twice, {});
  ASSERT_TRUE(pages.ok()) << pages.status().message();
  EXPECT_EQ(pages->left.near_after, 0);
  EXPECT_EQ(pages->left.near_after,
            left_part_gaps(mesh, twice, pages->layout.placements, {}).near_after);
  EXPECT_EQ(pages->opened, 1u);
}

TEST(PartGaps, OnlyOpenedChartsThatOutgrowTheirPageGetFewerTexels) {
  Stair stair;
  const Vec2d steep{kDensity, 4 * kDensity};  // longer along v than along u
  std::vector<ChartTexture> textures(1);
  const auto opened = [&](ChartContent content, std::int32_t max_side) {
    textures[0].texels_per_unit = steep;
    textures[0].content = content;
    open_texture_gaps(stair.pages(), {textures, max_side}, stair.charts, {});
    return textures[0].texels_per_unit;
  };
  EXPECT_EQ(opened(ChartContent::varied, 10000), steep);
  EXPECT_EQ(opened(ChartContent::uniform, 1), steep);
  const double height = stair.charts.charts[0].size.y * steep.y;
  const auto limit = std::int32_t(height) - 1;
  ASSERT_GT(limit, stair.charts.charts[0].size.x * steep.x);
  const Vec2d lowered = opened(ChartContent::varied, limit);
  EXPECT_NEAR(stair.charts.charts[0].size.y * lowered.y, limit, 1e-9 * limit);
  EXPECT_DOUBLE_EQ(lowered.y, 4 * lowered.x);
}

}  // namespace
}  // namespace atlas::test
