// One page of few charts and many specks: the charts are pressed, and the specks go into the gaps.
#include "libatlas/pack/pressing/specks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "tests/pack/one_page.h"
#include "tests/support/layout_checks.h"

namespace atlas {
namespace {

using namespace pack;
using test::box;
using test::options_for;

using Shapes = std::vector<std::vector<Vec2d>>;

// Stars, which leave much of any page empty.
Shapes stars(int count) {
  test::Noise noise{31};
  Shapes all;
  for (int k = 0; k < count; ++k) all.push_back(test::blob(noise, 60 + 100 * noise.unit(), 7));
  return all;
}

void add_boxes(int count, double width, double height, Shapes& shapes) {
  for (int k = 0; k < count; ++k) shapes.push_back(box(width, height));
}

std::vector<std::uint32_t> to_press(Shapes shapes) {
  const test::ChartItems charts(std::move(shapes));
  return charts_to_press(outlines_of(charts.shapes, {}), options_for(charts, 512));
}

std::vector<std::uint32_t> up_to(std::uint32_t count) {
  std::vector<std::uint32_t> all(count);
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

TEST(Specks, AreWhatIsSmallAmongMany) {
  Shapes shapes = stars(30);
  add_boxes(98, 6, 3, shapes);
  EXPECT_EQ(to_press(shapes), up_to(128)) << "few charts are all pressed";
  add_boxes(60, 6, 3, shapes);
  EXPECT_EQ(to_press(shapes), up_to(30));
  // A long one is no speck, however little of the page it takes.
  shapes.push_back(box(200, 0.5));
  std::vector<std::uint32_t> with_long = up_to(30);
  with_long.push_back(188);
  EXPECT_EQ(to_press(shapes), with_long);
}

TEST(Specks, AreNotMostOfThePage) {
  EXPECT_TRUE(to_press(stars(200)).empty());
  // So many small ones that only some of them would go into the gaps.
  Shapes shapes = stars(30);
  add_boxes(900, 12, 9, shapes);
  EXPECT_TRUE(to_press(shapes).empty());
}

// Arcs of 150 degrees, each turned by another angle.
Shapes arcs(int count) {
  Shapes all;
  for (int k = 0; k < count; ++k) {
    const double radius = 80 + 3.0 * k, width = 0.4 * radius;
    std::vector<Vec2d> arc;
    for (int i = 0; i < 30; ++i) {
      const auto at = [&](double r, int step) {
        const double angle = k + 2.6 * step / 30;
        return Vec2d{r * std::cos(angle), r * std::sin(angle)};
      };
      const Vec2d a = at(radius - width, i), b = at(radius, i), c = at(radius, i + 1),
                  d = at(radius - width, i + 1);
      arc.insert(arc.end(), {a, b, c, a, c, d});
    }
    all.push_back(std::move(arc));
  }
  return all;
}

TEST(Specks, GoIntoTheGapsOfAPressedPage) {
  Shapes shapes = arcs(12);
  add_boxes(150, 6, 3, shapes);
  const test::ChartItems charts(std::move(shapes));
  FitOptions o = options_for(charts, 512);
  o.power_of_two = false;
  for (const bool free_aspect : {true, false}) {
    o.free_aspect = free_aspect;
    const auto [pressed, again, cells] = test::press_and_fill(charts, o);
    ASSERT_TRUE(pressed.ok() && again.ok() && cells.ok());
    if (free_aspect) {
      EXPECT_GT(pressed->utilization, 1.01 * cells->utilization);
    } else {
      EXPECT_GT(pressed->scale, 1.005 * cells->scale);
    }
    EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, *pressed), pressed->pages, 1), "");
    test::expect_same(*pressed, *again);
  }
}

}  // namespace
}  // namespace atlas
