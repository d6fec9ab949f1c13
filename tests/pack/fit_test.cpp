#include "libatlas/pack/fit.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/pack/checks.h"

namespace atlas {
namespace {

FitResult fit(const std::vector<FitItem>& items, const FitOptions& options) {
  Result<FitResult> r = fit_pages(items, options, {});
  EXPECT_TRUE(r.ok()) << r.status().message();
  return r.ok() ? std::move(*r) : FitResult{};
}

void expect_valid(const std::vector<FitItem>& items, const FitOptions& o, const FitResult& r) {
  ASSERT_EQ(r.placements.size(), items.size());
  ASSERT_LE(r.pages.size(), o.pages);
  std::vector<Extent> boxes;
  std::vector<Placement> places;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const FitPlacement& p = r.placements[i];
    const auto side = [&](double extent) {
      const double scaled = std::ceil(extent * r.scale - 1e-6);
      return std::max({1.0, scaled, std::min<double>(o.minimum_side, std::ceil(extent))});
    };
    EXPECT_EQ(p.content_width, side(items[i].width));
    EXPECT_EQ(p.content_height, side(items[i].height));
    EXPECT_GE(p.box.width, (p.rotated ? p.content_height : p.content_width) + 2 * o.padding);
    EXPECT_GE(p.box.height, (p.rotated ? p.content_width : p.content_height) + 2 * o.padding);
    EXPECT_EQ(p.box.width % o.alignment, 0);
    EXPECT_EQ(p.box.height % o.alignment, 0);
    boxes.push_back({p.box.width, p.box.height});
    places.push_back({p.page, p.box.x, p.box.y, false});
  }
  PackOptions rules;
  rules.alignment = o.alignment;
  EXPECT_EQ(test::check_layout(boxes, places, r.pages, rules), "");
  if (o.power_of_two) {
    for (Extent p : r.pages) EXPECT_EQ((p.width & (p.width - 1)) | (p.height & (p.height - 1)), 0);
  }
}

FitResult valid_fit(const std::vector<FitItem>& items, const FitOptions& options) {
  FitResult r = fit(items, options);
  expect_valid(items, options, r);
  return r;
}

// Returns the area of the boxes, gutters included, / area of the pages.
double box_share(const FitResult& r) {
  double boxes = 0, pages = 0;
  for (const FitPlacement& p : r.placements) boxes += double(p.box.width) * p.box.height;
  for (const Extent& page : r.pages) pages += double(page.area());
  return boxes / pages;
}

// A texel of padding, boxes of any size, and no restriction on their positions.
FitOptions tight(std::int32_t page_size) {
  FitOptions o;
  o.page_size = page_size;
  o.padding = o.alignment = 1;
  o.minimum_side = 0;
  return o;
}

std::vector<FitItem> items_of(std::size_t count, double scale, std::uint64_t seed) {
  std::vector<FitItem> items;
  for (const Extent& e : test::log_normal_rects(count, seed))
    items.push_back({e.width * scale + 0.25, e.height * scale});
  return items;
}

TEST(FitPages, RandomProblems) {
  test::Noise noise{2};
  for (int round = 0; round < 60; ++round) {
    const std::uint64_t seed = noise.next();
    const double spread = 0.2 + 3 * noise.unit();
    const auto items = items_of(static_cast<std::size_t>(noise.in(1, 150)), spread, seed);
    FitOptions o;
    o.pages = static_cast<std::uint32_t>(noise.in(1, 4));
    o.page_size = 512;
    o.power_of_two = noise.in(0, 1);
    o.square = noise.in(0, 1);
    o.padding = noise.in(0, 2);
    o.alignment = 1 << noise.in(0, 2);
    o.minimum_side = noise.in(0, 1) ? 16 : 0;
    o.allow_rotation = noise.in(0, 1);
    const Result<FitResult> r = fit_pages(items, o, {});
    if (!r.ok()) {
      EXPECT_EQ(r.status().code(), ErrorCode::no_solution);
      continue;
    }
    expect_valid(items, o, *r);
    EXPECT_LE(r->scale, 1);
    EXPECT_LE(r->packings, o.max_packings);
  }
}

TEST(FitPages, FullPagesAtTheLargestScale) {
  const auto items = items_of(1500, 1, 6);
  FitOptions o = tight(512);
  o.pages = 2;
  const FitResult r = valid_fit(items, o);
  EXPECT_LT(r.scale, 1);
  EXPECT_GT(box_share(r), 0.97);
  EXPECT_EQ(r.pages.size(), 2u);
}

// Four pages with 6, 20 or 100 boxes each. Without a search, 0.838, 0.884 and 0.922 of the pages'
// area was filled.
TEST(FitPages, FewBoxesFillTheirPages) {
  for (const auto& [boxes, least] : {std::pair{6, 0.88}, {20, 0.90}, {100, 0.93}}) {
    double filled = 0;
    for (unsigned seed = 1; seed <= 4; ++seed) {
      test::Noise noise{seed};
      std::vector<FitItem> items(4 * std::size_t(boxes));
      for (FitItem& item : items) item = {double(noise.in(300, 900)), double(noise.in(300, 900))};
      FitOptions o;
      o.pages = 4;
      o.page_size = 2048;
      o.padding = 1;
      o.max_scale = 10;
      const Result<FitResult> fit = fit_pages(items, o, {});
      ASSERT_TRUE(fit.ok());
      filled += fit->utilization / 4;
    }
    EXPECT_GE(filled, least) << boxes;
  }
}

TEST(FitPages, SmallContentTakesFewSmallPages) {
  const std::vector<FitItem> items(4, FitItem{20, 20});
  FitOptions o;
  o.pages = 8;
  const FitResult r = valid_fit(items, o);
  EXPECT_EQ(r.scale, 1);
  ASSERT_EQ(r.pages.size(), 1u);
  EXPECT_EQ(r.pages[0], (Extent{64, 64}));
}

// Ten items of equal size never make six groups.
TEST(FitPages, PagesWithoutItemsAreLeftOut) {
  const std::vector<std::vector<Vec2d>> squares(
      10, {{0, 0}, {40, 0}, {40, 40}, {0, 0}, {40, 40}, {0, 40}});
  const test::ChartItems charts(squares);
  FitOptions o;
  o.pages = 6;
  o.page_size = 64;
  o.minimum_side = 0;
  for (const bool power_of_two : {true, false})
    for (const bool outlines : {false, true}) {
      o.power_of_two = power_of_two;
      o.shapes =
          outlines ? std::span<const ChartShape>(charts.shapes) : std::span<const ChartShape>();
      const FitResult r = fit(charts.items, o);
      std::vector<int> held(r.pages.size());
      for (const FitPlacement& p : r.placements) ++held.at(p.page);
      EXPECT_EQ(std::count(held.begin(), held.end(), 0), 0) << power_of_two << outlines;
      for (const Extent& page : r.pages) EXPECT_GT(page.area(), 0) << power_of_two << outlines;
    }
}

TEST(FitPages, MorePagesThanItemsTakeNoMemory) {
  FitOptions o;
  o.pages = UINT32_MAX;
  o.max_scale = 100;
  const FitResult r = fit({{50, 50}, {20, 30}}, o);
  EXPECT_LE(r.pages.size(), 2u);
}

TEST(FitPages, TheLargestScaleMayBeFarFromWhatFits) {
  FitOptions o;
  o.page_size = 256;
  o.max_scale = 1e300;
  const FitResult r = fit({{50, 50}, {20, 30}}, o);
  EXPECT_GT(r.scale, 3);
}

// If few packings are allowed, the search may end at its first scale, at which all charts have the
// minimum sides. It must not end at zero.
TEST(FitPages, TheScaleIsNeverZero) {
  const std::vector<FitItem> items(30, FitItem{200, 160});
  FitOptions o;
  o.page_size = 128;
  o.max_packings = 2;
  o.minimum_side = 4;
  o.padding = 1;
  o.alignment = 2;
  const FitResult r = valid_fit(items, o);
  EXPECT_GE(r.scale, 4.0 / 200);
}

// Thousands of boxes on one page of any shape: the layout is full and valid, and no row is empty.
TEST(FitPages, ManyItemsFillOnePage) {
  const auto items = items_of(4000, 1, 8);
  FitOptions o = tight(1024);
  o.free_aspect = true;
  const FitResult r = fit(items, o);
  o.power_of_two = false;  // this is what free_aspect implies
  expect_valid(items, o, r);
  ASSERT_EQ(r.pages.size(), 1u);
  EXPECT_GT(box_share(r), 0.97);
  EXPECT_LT(r.scale, 1);
}

// Pages are cropped to their charts even where pressing is not tried.
TEST(FitPages, ManyItemsFillSeveralPages) {
  std::vector<FitItem> items{{900, 500}};
  test::Noise noise{12};
  for (int i = 0; i < 5000; ++i)
    items.push_back({4 + 26.0 * noise.unit(), 4 + 26.0 * noise.unit()});
  FitOptions o = tight(512);
  o.pages = 3;
  const FitResult r = valid_fit(items, o);
  EXPECT_EQ(r.pages.size(), 3u);
  EXPECT_LT(r.scale, 0.57) << "the largest box is as wide as the page";
  EXPECT_GT(box_share(r), 0.96);
  EXPECT_EQ(r.grouping.group.size(), items.size());
}

TEST(FitPages, FreePagesAreCropped) {
  const test::ChartItems charts({{{0, 0}, {400, 0}, {400, 20}}, {{0, 0}, {400, 20}, {0, 20}}});
  FitOptions o = tight(256);
  o.free_aspect = true;
  o.preset = PackPreset::fast;
  for (const bool outlines : {false, true}) {
    if (outlines) o.shapes = charts.shapes;
    const FitResult r = fit(charts.items, o);
    ASSERT_EQ(r.pages.size(), 1u);
    EXPECT_LT(std::min(r.pages[0].width, r.pages[0].height), 40) << outlines;
  }
}

// The largest side of pages of any shape need not be a power of two.
TEST(FitPages, FreePagesHaveAnyLargestSide) {
  FitOptions o;
  o.page_size = 1000;
  o.free_aspect = true;
  const Result<FitResult> fitted = fit_pages(std::vector<FitItem>{{900, 30}, {700, 40}}, o, {});
  ASSERT_TRUE(fitted.ok()) << fitted.status().message();
  EXPECT_LE(fitted->pages[0].width, 1000);
  o.free_aspect = false;
  EXPECT_FALSE(fit_pages(std::vector<FitItem>{{900, 30}}, o, {}).ok());
}

TEST(FitPages, Failures) {
  FitOptions o;
  o.page_size = 64;
  const std::vector<FitItem> many(100, FitItem{50, 50});
  EXPECT_EQ(fit_pages(many, o, {}).status().code(), ErrorCode::no_solution);
  const std::vector<FitItem> bad{{-1, 4}};
  EXPECT_EQ(fit_pages(bad, o, {}).status().code(), ErrorCode::bad_input);
  o.pages = 0;
  EXPECT_EQ(fit_pages(many, o, {}).status().code(), ErrorCode::bad_option);
  o.pages = 1;
  o.max_packings = 1;
  EXPECT_EQ(fit_pages(many, o, {}).status().code(), ErrorCode::bad_option);
  o.max_packings = 2;
  o.page_size = 60;
  EXPECT_EQ(fit_pages(many, o, {}).status().code(), ErrorCode::bad_option);
  EXPECT_TRUE(fit_pages({}, {}, {}).ok());
}

// A padding this large overflowed when it was doubled, and a negative budget never ended.
TEST(FitPages, OptionsOutOfRange) {
  const std::vector<FitItem> one{{4, 4}};
  const auto refused = [&](auto change) {
    FitOptions o;
    o.page_size = 64;
    change(o);
    const Result<FitResult> fit = fit_pages(one, o, {});
    return fit.ok() ? "" : std::string(fit.status().message());
  };
  EXPECT_EQ(refused([](FitOptions&) {}), "");
  EXPECT_EQ(refused([](FitOptions& o) { o.page_size = (1 << 20) + 1; }),
            "fit: page_size is 1048577 (1 .. 1048576)");
  EXPECT_EQ(refused([](FitOptions& o) { o.padding = 30; }), "");
  for (const std::int32_t padding : {31, 1 << 30})
    EXPECT_EQ(refused([&](FitOptions& o) { o.padding = padding; }),
              fmt::format("fit: padding {} on both sides and alignment 4 leave no room on pages of "
                          "64 texels (use larger pages)",
                          padding));
  EXPECT_NE(refused([](FitOptions& o) { o.alignment = 1 << 30; }), "");
  for (const double budget : {-1.0, std::nan("")})
    EXPECT_EQ(refused([&](FitOptions& o) { o.time_budget = budget; }),
              "fit: time_budget is negative or not a number");
}

// Gutters that take the very last texel leave none for a chart.
TEST(FitPages, NothingFitsBetweenGutters) {
  for (const int count : {4, 16}) {
    test::Noise noise{3};
    std::vector<std::vector<Vec2d>> blobs;
    for (int k = 0; k < count; ++k) blobs.push_back(test::blob(noise, 20 + k, 7));
    const test::ChartItems charts(std::move(blobs));
    FitOptions o;
    o.page_size = 256;
    o.padding = count == 4 ? 64 : 32;
    o.alignment = 1;
    o.minimum_side = 0;
    o.shapes = charts.shapes;
    EXPECT_EQ(fit_pages(charts.items, o, {}).status().code(), ErrorCode::no_solution) << count;
    o.padding /= 2;
    const Result<FitResult> fit = fit_pages(charts.items, o, {});
    ASSERT_TRUE(fit.ok());
    EXPECT_EQ(fit->placements.size(), charts.items.size());
  }
}

TEST(FitPages, OutlinesFitMoreThanBoxes) {
  test::Noise noise{31};
  std::vector<std::vector<Vec2d>> blobs;
  for (int k = 0; k < 120; ++k) blobs.push_back(test::blob(noise, 20 + 60 * noise.unit(), 7));
  const test::ChartItems charts(std::move(blobs));
  FitOptions o;
  o.pages = 2;
  o.page_size = 256;
  o.padding = 2;
  o.alignment = 4;
  o.minimum_side = 0;
  const FitResult boxes = fit(charts.items, o);
  o.shapes = charts.shapes;
  const FitResult outlines = fit(charts.items, o);
  EXPECT_GT(outlines.scale, boxes.scale);
  for (const FitPlacement& p : outlines.placements) EXPECT_GE(p.scale, outlines.scale);
  EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, outlines), outlines.pages, o.padding),
            "");
}

// Rectangles; a third of them have a slanted side.
test::ChartItems straight_charts(std::uint64_t seed, int count) {
  test::Noise noise{seed};
  std::vector<std::vector<Vec2d>> shapes;
  for (int k = 0; k < count; ++k) {
    const double w = 10 + 50 * noise.unit(), h = 10 + 25 * noise.unit();
    const double cut = k % 3 == 0 ? 0.6 * w : 0;
    shapes.push_back({{0, 0}, {w, 0}, {w - cut, h}, {0, 0}, {w - cut, h}, {0, h}});
  }
  return test::ChartItems(std::move(shapes));
}

// At oblique angles each chart finds a lower place, but the layout as a whole gets worse.
TEST(FitPages, MoreDirectionsAreNeverWorseThanFour) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const test::ChartItems charts = straight_charts(seed, 60);
    FitOptions o = tight(128);
    o.pages = 2;
    o.shapes = charts.shapes;
    const double four = fit(charts.items, o).scale;
    for (const std::uint32_t rotations : {8u, 16u, 64u}) {
      o.rotations = rotations;
      const FitResult more = fit(charts.items, o);
      EXPECT_GE(more.scale, four) << rotations;
      EXPECT_LE(more.packings, o.max_packings);
      EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, more), more.pages, o.padding), "");
    }
  }
}

// Triangles of given uvs may lie on each other many times, as in charts of tiled textures.
TEST(FitPages, ChartsThatLieOnThemselvesTakeTheirRoomOnce) {
  std::vector<std::vector<Vec2d>> once, often;
  test::Noise noise{7};
  for (int k = 0; k < 40; ++k) {
    const double w = 10 + 50 * noise.unit(), h = 10 + 25 * noise.unit();
    once.push_back({{0, 0}, {w, 0}, {w, h}, {0, 0}, {w, h}, {0, h}});
    often.push_back(once.back());
    for (int copy = 0; copy < 9; ++copy) {  // every other copy has the opposite orientation
      const double x = w * copy / 9;
      if (copy % 2 == 0)
        often.back().insert(often.back().end(), {{0, 0}, {x, 0}, {w, h}});
      else
        often.back().insert(often.back().end(), {{0, 0}, {w, h}, {x, 0}});
      often.back().insert(often.back().end(), once.back().begin(), once.back().end());
    }
  }
  const test::ChartItems single(std::move(once)), stacked(std::move(often));
  FitOptions o = tight(256);
  o.shapes = single.shapes;
  const FitResult wanted = fit(single.items, o);
  o.shapes = stacked.shapes;
  const FitResult result = fit(stacked.items, o);
  EXPECT_GT(result.scale, 0.97 * wanted.scale);
  EXPECT_NEAR(result.utilization / (result.scale * result.scale),
              wanted.utilization / (wanted.scale * wanted.scale), 1e-3);
  EXPECT_EQ(test::check_outlines(test::placed_shapes(stacked, result), result.pages, o.padding),
            "");
}

// A page of any shape gets the fuller of two layouts: in rows or on cells.
TEST(FitPages, FewStraightChartsFillAPageAsWellAsByCells) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const test::ChartItems charts = straight_charts(seed, 12);
    FitOptions o = tight(512);
    o.max_scale = 100;
    o.free_aspect = true;
    o.power_of_two = false;
    o.shapes = charts.shapes;
    const FitResult either = fit(charts.items, o);
    EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, either), either.pages, o.padding),
              "");
    o.any_angle = false;
    EXPECT_GE(either.utilization, fit(charts.items, o).utilization) << seed;
  }
}

// The page is too small for pressing, and only the effort limits packings that fail.
TEST(FitPages, PackingsShareTheEffort) {
  test::Noise noise{5};
  std::vector<std::vector<Vec2d>> blobs;
  for (int k = 0; k < 6; ++k) blobs.push_back(test::blob(noise, 20 + 10 * noise.unit(), 7));
  const test::ChartItems charts(std::move(blobs));
  FitOptions o;
  o.page_size = 64;
  o.padding = o.alignment = 1;
  o.minimum_side = 0;
  o.max_scale = 100;
  o.free_aspect = true;
  o.shapes = charts.shapes;
  const Result<FitResult> standard = fit_pages(charts.items, o, {});
  o.preset = PackPreset::best;
  o.effort = 8000;
  const Result<FitResult> best = fit_pages(charts.items, o, {});
  ASSERT_TRUE(standard.ok() && best.ok());
  EXPECT_GE(best->scale, standard->scale);
  EXPECT_GT(best->layouts, standard->layouts);
  EXPECT_LE(best->layouts, 3 * o.effort);
}

}  // namespace
}  // namespace atlas
