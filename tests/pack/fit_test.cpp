#include "libatlas/pack/fit.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/pack/fits.h"
#include "tests/support/layout_checks.h"

namespace atlas {
namespace {

using test::fit;
using test::tight;

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
      o.alignment = 4;
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
  o.alignment = 4;
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
  o.alignment = 4;
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
  o.alignment = 4;
  o.pages = UINT32_MAX;
  o.max_scale = 100;
  const FitResult r = fit({{50, 50}, {20, 30}}, o);
  EXPECT_LE(r.pages.size(), 2u);
}

TEST(FitPages, TheLargestScaleMayBeFarFromWhatFits) {
  FitOptions o;
  o.alignment = 4;
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

// The groups of F(A) = N are told in texels, whatever cells the charts lie on.
TEST(FitPages, GroupsAreToldInTexels) {
  const test::ChartItems charts(std::vector<std::vector<Vec2d>>(
      9, {{0, 0}, {200, 0}, {200, 120}, {0, 0}, {200, 120}, {0, 120}}));
  FitOptions o = tight(256);
  o.pages = 3;
  o.padding = 2;
  o.alignment = 4;
  for (const bool outlines : {false, true}) {
    if (outlines) o.shapes = charts.shapes;
    const FitResult r = fit(charts.items, o);
    const GroupingResult& groups = r.grouping;
    ASSERT_EQ(groups.group_size.size(), 3u);
    std::uint64_t boxes = 0, sum = 0;
    for (const FitPlacement& p : r.placements) boxes += std::uint64_t(p.box.area());
    for (const std::uint64_t size : groups.group_size) sum += size;
    EXPECT_LE(sum, boxes) << outlines;
    EXPECT_GE(double(sum), 9 * 200 * 120 * r.scale * r.scale) << outlines;
    if (!outlines) {
      EXPECT_EQ(sum, boxes);
    }
    EXPECT_EQ(groups.largest_group,
              *std::max_element(groups.group_size.begin(), groups.group_size.end()));
    EXPECT_GE(groups.capacity, groups.largest_group);
    EXPECT_LE(groups.lower_bound, groups.capacity);
    EXPECT_GE(groups.upper_bound, groups.capacity);
    EXPECT_TRUE(std::any_of(groups.trace.begin(), groups.trace.end(), [&](const GroupingStep& s) {
      return s.capacity >= groups.capacity && s.groups <= 3;
    }));
  }
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
  o.alignment = 4;
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
  o.alignment = 4;
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
    o.alignment = 4;
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

}  // namespace
}  // namespace atlas
