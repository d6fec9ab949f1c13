// How fine the cells are when many charts are packed on them.
#include <gtest/gtest.h>

#include <vector>

#include "libatlas/pack/fit.h"
#include "tests/pack/checks.h"
#include "tests/pack/one_page.h"

namespace atlas {
namespace {

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
