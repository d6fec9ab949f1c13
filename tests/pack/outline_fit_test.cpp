// How fine the cells are when many charts are packed on them, and how many layouts are drawn.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "libatlas/pack/fit.h"
#include "tests/pack/one_page.h"
#include "tests/support/layout_checks.h"

namespace atlas {
namespace {

// Three draws of a page of twenty shapes that stays poorly filled took 1920 layouts.
TEST(OutlineFit, PoorPagesAreDrawnWithFewLayouts) {
  std::vector<std::vector<Vec2d>> shapes;
  test::Noise noise{3};
  for (int k = 0; k < 20; ++k) {
    const double a = 20 + 60 * noise.unit(), b = 8;  // an L of two bars
    shapes.push_back({{0, 0},
                      {a, 0},
                      {a, b},
                      {0, 0},
                      {a, b},
                      {0, b},
                      {0, 0},
                      {b, 0},
                      {b - 0.5 * a, a},
                      {0, 0},
                      {b - 0.5 * a, a},
                      {-0.5 * a, a}});
  }
  const test::ChartItems charts(std::move(shapes));
  FitOptions o;
  o.page_size = 512;
  o.alignment = 1;
  o.minimum_side = 0;
  o.max_scale = 100;
  o.shapes = charts.shapes;
  o.free_aspect = true;
  const Result<FitResult> fit = fit_pages(charts.items, o, {});
  ASSERT_TRUE(fit.ok());
  EXPECT_LT(fit->utilization, 0.7);
  EXPECT_LE(fit->layouts, 1400u);
  EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, *fit), fit->pages, o.padding), "");
}

// Equal discs lie more densely in rows of boxes, and then have the places of outlines as well.
TEST(OutlineFit, BoxesAreTakenWhereTheyFillMore) {
  std::vector<std::vector<Vec2d>> shapes;
  for (int k = 0; k < 9; ++k) {
    std::vector<Vec2d> disc;
    for (int i = 0; i < 48; ++i) {
      const double a = 2 * 3.14159265358979 * i / 48, b = 2 * 3.14159265358979 * (i + 1) / 48;
      disc.insert(disc.end(), {{5, 7},
                               {5 + 50 * std::cos(a), 7 + 50 * std::sin(a)},
                               {5 + 50 * std::cos(b), 7 + 50 * std::sin(b)}});
    }
    shapes.push_back(std::move(disc));
  }
  const test::ChartItems charts(std::move(shapes));
  FitOptions o;
  o.page_size = 512;
  o.power_of_two = false;
  o.alignment = 1;
  o.minimum_side = 0;
  o.max_scale = 100;
  o.shapes = charts.shapes;
  const Result<FitResult> outlines = fit_pages(charts.items, o, {});
  const Result<FitResult> better = fit_boxes_or_outlines(charts.items, o, {});
  ASSERT_TRUE(outlines.ok() && better.ok());
  EXPECT_TRUE(better->boxes);
  EXPECT_GT(better->scale, outlines->scale);
  EXPECT_GT(better->filled, 0.74);
  EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, *better), better->pages, o.padding),
            "");
}

// Boxes that fill their page leave outlines nothing to win, but a wrong shape is still told.
TEST(OutlineFit, WrongShapesAreToldWhereBoxesWouldDo) {
  const std::vector<Vec2d> box = test::box(60, 60);
  const std::vector<std::uint32_t> beyond{0, 1, 600'000'000};
  const std::vector<FitItem> items{{60, 60}};
  FitOptions o;
  o.alignment = 4;
  o.page_size = 64;
  const std::vector<ChartShape> right{{box, {}}}, wrong{{box, beyond}};
  o.shapes = right;
  EXPECT_TRUE(fit_boxes_or_outlines(items, o, {}).ok());
  o.shapes = wrong;
  EXPECT_EQ(fit_boxes_or_outlines(items, o, {}).status().code(), ErrorCode::bad_input);
}

// Coarse cells, as the number of needles alone would suggest, lose two percent of the page around
// them.
TEST(OutlineFit, NeedlesLieOnFineCells) {
  test::Noise noise{8};
  std::vector<std::vector<Vec2d>> needles;
  double area = 0;
  for (int k = 0; k < 1200; ++k) {
    const double w = 100 + 300 * noise.unit(), h = 4 + 4 * noise.unit();
    needles.push_back(test::box(w, h));
    area += w * h;
  }
  const test::ChartItems charts(std::move(needles));
  FitOptions o = test::options_for(charts, 2048);
  const Result<FitResult> fitted = fit_pages(charts.items, o, {});
  ASSERT_TRUE(fitted.ok());
  const FitResult& page = *fitted;
  EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, page), page.pages, o.padding), "");
  const double texels = double(page.pages[0].area());
  EXPECT_NEAR(page.utilization, area * page.scale * page.scale / texels, 1e-6);
  EXPECT_GT(page.utilization, 0.66);
}

}  // namespace
}  // namespace atlas
