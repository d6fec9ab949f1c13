// Large rectangles are cut so that they suit the pages, if that is worth the seams.
#include "libatlas/pipeline/suit_pages.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <utility>

#include "tests/support/shape_view.h"

namespace atlas::test {
namespace {

Shape plates(int count) {
  Shape shape = grid(24, 24, 1, 1);
  for (int i = 1; i < count; ++i)
    shape = together(shape, moved(grid(24, 24, 1, 1), 1, {0, 2.0 * i, 0}));
  return shape;
}

// Plates of one unit that want 400 x 400 texels each.
SizedCharts sized_plates(const Shape& shape) {
  SizedCharts sized;
  auto charts = make_charts(view_of(shape), {}, {});
  EXPECT_TRUE(charts.ok());
  sized.charts = std::move(*charts);
  sized.densities.assign(sized.charts.charts.size(), {400, 400});
  sized.full_densities.assign(sized.charts.charts.size(), {800, 800});
  return sized;
}

const LayoutOptions kOnePage{{.page_size = 512, .alignment = 4}};

double scale_of(const SizedCharts& sized) {
  const auto layout = lay_out_pages(sized.charts, sized.densities, kOnePage, {});
  EXPECT_TRUE(layout.ok());
  return layout->scale;
}

// Five squares need the room of nine.
TEST(SuitPages, PlatesThatLeaveThePageHalfEmptyAreCut) {
  const Shape shape = plates(5);
  SizedCharts sized = sized_plates(shape);
  ASSERT_EQ(sized.charts.charts.size(), 5u);
  const double before = scale_of(sized), seams = sized.charts.seam_length;
  sized.full_densities[4] = {700, 700};
  const auto cut = suit_pages({view_of(shape)}, kOnePage, sized, {});
  ASSERT_TRUE(cut.ok());
  EXPECT_EQ(*cut, 5u);
  EXPECT_GT(sized.charts.charts.size(), 5u);
  EXPECT_GT(sized.charts.seam_length, seams);
  ASSERT_EQ(sized.densities.size(), sized.charts.charts.size());
  ASSERT_EQ(sized.full_densities.size(), sized.charts.charts.size());
  EXPECT_GT(scale_of(sized), 1.1 * before);
  double area = 0;
  for (std::size_t c = 0; c < sized.densities.size(); ++c) {
    EXPECT_EQ(sized.densities[c].x, 400);
    if (sized.full_densities[c].x == 700) area += sized.charts.charts[c].distortion.surface_area;
  }
  EXPECT_NEAR(area, 1, 1e-6) << "pieces have the densities of their plate";
}

TEST(SuitPages, PlatesThatFillThePageStayWhole) {
  const Shape shape = plates(4);
  SizedCharts sized = sized_plates(shape);
  const auto cut = suit_pages({view_of(shape)}, kOnePage, sized, {});
  ASSERT_TRUE(cut.ok());
  EXPECT_EQ(*cut, 0u);
  EXPECT_EQ(sized.charts.charts.size(), 4u);
}

// Textures that fit at full size gain nothing.
TEST(SuitPages, PlatesWithRoomToSpareStayWhole) {
  const Shape shape = plates(5);
  SizedCharts sized = sized_plates(shape);
  sized.densities.assign(5, {100, 100});
  const auto cut = suit_pages({view_of(shape)}, kOnePage, sized, {});
  ASSERT_TRUE(cut.ok());
  EXPECT_EQ(*cut, 0u);
}

// The textures of charts of one colour have a density for each side, which pieces could not keep if
// they are turned.
TEST(SuitPages, ChartsWithTwoDensitiesStayWhole) {
  const Shape shape = plates(5);
  SizedCharts sized = sized_plates(shape);
  sized.densities.assign(5, {400, 399});
  const auto cut = suit_pages({view_of(shape)}, kOnePage, sized, {});
  ASSERT_TRUE(cut.ok());
  EXPECT_EQ(*cut, 0u);
}

}  // namespace
}  // namespace atlas::test
