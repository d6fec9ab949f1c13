#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "libatlas/core/clock.h"
#include "libatlas/pack/pack.h"
#include "tests/support/layout_checks.h"
#include "tests/support/slowness.h"

namespace atlas {
namespace {

PackResult pack(const std::vector<Extent>& items, const PackOptions& options, int threads = 0) {
  Context context;
  context.threads = threads;
  Result<PackResult> r = pack_rects(items, options, context);
  EXPECT_TRUE(r.ok()) << r.status().message();
  return r.ok() ? std::move(*r) : PackResult{};
}

// Adds up the areas that the result states from its placements and pages.
void expect_stated_areas(const std::vector<Extent>& items, const PackResult& r) {
  std::vector<double> filled(r.pages.size());
  double items_area = 0;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (!r.placements[i].placed() || items[i].area() == 0) continue;
    items_area += static_cast<double>(items[i].area());
    filled[r.placements[i].page] += static_cast<double>(items[i].area());
  }
  EXPECT_EQ(static_cast<double>(r.placed_area), items_area);
  const auto fill = [&](std::size_t pages, double of_none) {
    double area = 0, total = 0;
    for (std::size_t p = 0; p < pages; ++p) {
      area += filled[p];
      total += static_cast<double>(r.pages[p].area());
    }
    return total > 0 ? area / total : of_none;
  };
  EXPECT_NEAR(r.utilization, fill(filled.size(), 0), 1e-12);
  EXPECT_NEAR(r.fill_without_last, fill(std::max<std::size_t>(filled.size(), 1) - 1, 1), 1e-12);
}

TEST(PackRects, RandomOptionsKeepTheRules) {
  test::Noise noise{1};
  const PackPreset presets[] = {PackPreset::fast, PackPreset::standard, PackPreset::best};
  const PackEngine engines[] = {PackEngine::automatic, PackEngine::automatic,
                                PackEngine::skyline_bottom_left, PackEngine::skyline_min_waste,
                                PackEngine::max_rects};
  for (int round = 0; round < 1500; ++round) {
    std::vector<Extent> items(static_cast<std::size_t>(noise.in(0, 40)));
    for (Extent& e : items) e = {noise.in(0, 30), noise.in(0, 30)};
    PackOptions o;
    o.page = {noise.in(20, 80), noise.in(0, 3) ? noise.in(20, 80) : 0};
    o.allow_rotation = noise.in(0, 1);
    o.padding = noise.in(0, 2);
    o.border = noise.in(0, 3);
    o.alignment = noise.in(0, 2) ? 1 : 4;
    o.max_pages = noise.in(0, 2) ? 0u : 2u;
    o.crop = noise.in(0, 1);
    o.preset = presets[noise.in(0, 2)];
    o.engine = engines[noise.in(0, 4)];
    o.effort = 40;
    std::vector<PinnedRect> pins;
    if (noise.in(0, 2) == 0 && o.page.height > 0)
      for (int k = noise.in(1, 3); k > 0; --k)
        pins.push_back({static_cast<std::uint32_t>(noise.in(0, 1)),
                        {noise.in(-5, 60), noise.in(-5, 60), noise.in(0, 20), noise.in(0, 20)}});
    o.pinned = pins;
    const PackResult r = pack(items, o, 1);
    ASSERT_EQ(test::check_layout(items, r.placements, r.pages, o), "") << "round " << round;
    std::size_t missing = 0;
    for (std::size_t i = 0; i < items.size(); ++i) missing += !r.placements[i].placed();
    ASSERT_EQ(missing, r.unplaced.size());
    expect_stated_areas(items, r);
    for (const UnplacedItem& u : r.unplaced) {
      if (o.max_pages == 0 && o.page.height > 0) {
        EXPECT_EQ(u.reason, UnplacedReason::too_large) << "round " << round;
      }
    }
  }
}

TEST(PackRects, DegenerateSizes) {
  PackOptions o;
  o.page = {64, 64};
  o.allow_rotation = true;
  const std::vector<Extent> items{{0, 5}, {64, 64}, {65, 1}, {1000000000, 1000000000}, {0, 0}};
  for (PackPreset preset : {PackPreset::fast, PackPreset::standard, PackPreset::best}) {
    o.preset = preset;
    o.effort = 10;
    const PackResult r = pack(items, o);
    EXPECT_TRUE(r.placements[0].placed());
    EXPECT_EQ(r.placements[1], (Placement{0, 0, 0, false}));
    ASSERT_EQ(r.unplaced.size(), 2u);
    EXPECT_EQ(r.unplaced[0].item, 2u);
    EXPECT_EQ(r.unplaced[0].reason, UnplacedReason::too_large);
    EXPECT_EQ(r.unplaced[1].item, 3u);
    EXPECT_EQ(r.pages.size(), 1u);
  }
  o.crop = true;
  EXPECT_EQ(pack({{0, 50}, {4, 7}}, o).pages[0], (Extent{4, 7}));
}

TEST(PackRects, BadOptionsAreNamed) {
  const std::vector<Extent> one{{1, 1}};
  const auto code = [&](auto change) {
    PackOptions o;
    change(o);
    return pack_rects(one, o, {}).status().code();
  };
  EXPECT_EQ(code([](PackOptions& o) { o.page = {-1, 5}; }), ErrorCode::bad_option);
  EXPECT_EQ(code([](PackOptions& o) { o.padding = -1; }), ErrorCode::bad_option);
  EXPECT_EQ(code([](PackOptions& o) {
              o.page = {1 << 30, 1}, o.padding = 1;
            }),
            ErrorCode::bad_option);
  EXPECT_EQ(code([](PackOptions& o) { o.alignment = 0; }), ErrorCode::bad_option);
  EXPECT_EQ(code([](PackOptions& o) {
              o.page = {100, 64}, o.power_of_two = true;
            }),
            ErrorCode::bad_option);
  EXPECT_EQ(code([](PackOptions& o) { o.time_budget = std::numeric_limits<double>::quiet_NaN(); }),
            ErrorCode::bad_option);
  const std::vector<Extent> negative{{3, -1}};
  EXPECT_EQ(pack_rects(negative, {}, {}).status().code(), ErrorCode::bad_input);
}

// Areas are summed in 63 bits: those of the items, and of the cells that they take with their
// padding.
TEST(PackRects, AreasThatNoSumHoldsAreRefused) {
  PackOptions o;
  o.page = {1 << 30, 1 << 30};
  const std::vector<Extent> four(4, o.page);
  const PackResult r = pack(four, o);
  EXPECT_EQ(r.pages.size(), 4u);
  EXPECT_EQ(r.placed_area, std::int64_t{1} << 62);
  EXPECT_EQ(r.utilization, 1);
  const std::vector<Extent> nine(9, o.page);
  for (const PackPreset preset : {PackPreset::fast, PackPreset::standard}) {
    o.preset = preset;
    EXPECT_EQ(pack_rects(nine, o, {}).status().code(), ErrorCode::bad_input);
  }
  const std::vector<Extent> small(1 << 15, {1, 1});
  o.padding = (1 << 24) - 1;
  o.page = {1 << 29, 1 << 29};
  EXPECT_EQ(pack_rects(small, o, {}).status().code(), ErrorCode::bad_input);
  o.padding = 0;
  o.page.width = 1 << 20;  // items that fit no page are not part of the sum
  EXPECT_EQ(pack(nine, o).unplaced.size(), 9u);
}

TEST(PackRects, CancelledWorkSaysSo) {
  const std::atomic<bool> stop{true};
  Context context;
  context.cancel = &stop;
  const std::vector<Extent> items(50, {3, 4});
  EXPECT_EQ(pack_rects(items, {}, context).status().code(), ErrorCode::cancelled);
}

// Cancelled at the start, packing does nothing but sort the items.
TEST(PackRects, CancelledWorkOnManyItemsEndsSoon) {
  const std::atomic<bool> stop{true};
  Context context;
  context.cancel = &stop;
  const std::vector<Extent> items = test::log_normal_rects(100'000, 5);
  PackOptions o;
  for (const PackEngine engine : {PackEngine::automatic, PackEngine::skyline_bottom_left,
                                  PackEngine::skyline_min_waste, PackEngine::max_rects})
    for (const bool rotation : {false, true})
      for (const Extent page : {Extent{2048, 2048}, Extent{1 << 14, 0}, Extent{0, 0}}) {
        o.engine = engine;
        o.allow_rotation = rotation;
        o.page = page;
        const double begun = cpu_seconds();
        EXPECT_EQ(pack_rects(items, o, context).status().code(), ErrorCode::cancelled);
        EXPECT_LT(cpu_seconds() - begun, 0.1 * test::kSlowness) << int(engine) << " " << page.width;
      }
}

TEST(PackRects, SameResultForEveryThreadCount) {
  const std::vector<Extent> items = test::log_normal_rects(90, 4);
  for (bool strip : {false, true}) {
    PackOptions o;
    o.page = {256, strip ? 0 : 512};
    o.page.width = 512;
    o.preset = PackPreset::best;
    o.effort = 400;
    o.time_budget = std::numeric_limits<double>::infinity();
    const PackResult one = pack(items, o, 1);
    for (int threads : {2, 3, 8}) EXPECT_EQ(pack(items, o, threads).placements, one.placements);
  }
}

// This layout is fixed. Whoever changes it on purpose has to change the number and say why.
TEST(PackRects, GoldenLayout) {
  const std::vector<Extent> items = test::log_normal_rects(200, 20240601);
  const auto fingerprint = [&](PackPreset preset) {
    PackOptions o;
    o.page = {512, 512};
    o.allow_rotation = true;
    o.preset = preset;
    const PackResult r = pack(items, o);
    EXPECT_EQ(test::check_layout(items, r.placements, r.pages, o), "");
    std::uint64_t hash = 1469598103934665603u;
    for (const Placement& p : r.placements)
      for (std::uint64_t v : {std::uint64_t{p.page}, std::uint64_t(p.x), std::uint64_t(p.y),
                              std::uint64_t{p.rotated}})
        hash = (hash ^ v) * 1099511628211u;
    return hash;
  };
  EXPECT_EQ(fingerprint(PackPreset::fast), 4082645723248373748u);
  EXPECT_EQ(fingerprint(PackPreset::standard), 14196421012171596673u);
}

TEST(PackRects, BoundsAreNeverPassed) {
  test::Noise noise{21};
  for (int round = 0; round < 200; ++round) {
    std::vector<Extent> items(static_cast<std::size_t>(noise.in(1, 30)));
    for (Extent& e : items) e = {noise.in(1, 20), noise.in(1, 20)};
    PackOptions o;
    o.page = {20, 20};
    o.allow_rotation = noise.in(0, 1);
    const PackResult r = pack(items, o, 1);
    EXPECT_LE(r.page_lower_bound, r.pages.size());
    EXPECT_TRUE(r.unplaced.empty());
  }
}

TEST(PackRects, ManyLogNormalRectanglesFillTheirPages) {
  const std::vector<Extent> items = test::log_normal_rects(10000, 20240601);
  const PackResult r = pack(items, {});
  EXPECT_EQ(r.pages.size(), 7u);
  EXPECT_GE(r.fill_without_last, 0.998);
}

TEST(PackRects, PagesTakeTheShapeAskedFor) {
  const std::vector<Extent> items = test::log_normal_rects(30, 8);
  PackOptions o;
  o.page = {1024, 1024};
  o.crop = o.power_of_two = true;
  for (Extent p : pack(items, o).pages) {
    EXPECT_EQ(p.width & (p.width - 1), 0);
    EXPECT_EQ(p.height & (p.height - 1), 0);
  }
  o = {};
  o.page = {0, 0};
  const PackResult free = pack(items, o);
  ASSERT_EQ(free.pages.size(), 1u);
  EXPECT_EQ(test::check_layout(items, free.placements, free.pages, o), "");
  EXPECT_GT(free.utilization, 0.8);
  o.square = true;
  const PackResult square = pack(items, o);
  EXPECT_EQ(square.pages[0].width, square.pages[0].height);
}

// A cropped page is narrower than the page may be; a square one is as high as it is wide.
TEST(PackRects, CroppedPagesAreNoLargerThanNeeded) {
  test::Noise noise{9};
  for (const int n : {12, 200, 1500}) {
    std::vector<Extent> items(static_cast<std::size_t>(n));
    for (Extent& e : items) e = {noise.in(4, 90), noise.in(4, 90)};
    PackOptions o;
    o.page = {4096, 4096};
    o.crop = true;
    for (const PackPreset preset : {PackPreset::fast, PackPreset::standard, PackPreset::best})
      for (const bool square : {false, true}) {
        o.preset = preset;
        o.square = square;
        o.effort = 50;
        const PackResult r = pack(items, o);
        ASSERT_EQ(r.pages.size(), 1u);
        EXPECT_EQ(test::check_layout(items, r.placements, r.pages, o), "");
        EXPECT_GE(r.utilization, preset == PackPreset::fast ? 0.6 : 0.75) << n << " " << square;
      }
  }
  // If no narrower page holds the items, the page keeps its full size.
  PackOptions o;
  o.page = {64, 64};
  o.crop = true;
  const PackResult full = pack(std::vector<Extent>(16, {16, 16}), o);
  ASSERT_EQ(full.pages.size(), 1u);
  EXPECT_EQ(full.pages[0], (Extent{64, 64}));
}

TEST(PackRects, PowersOfTwoAreTheSmallest) {
  PackOptions o;
  o.page = {4096, 4096};
  o.crop = o.power_of_two = true;
  o.padding = 2;
  const std::vector<Extent> items(100, {23, 23});  // ten of them make a row of 248 texels
  for (const Extent page : {Extent{4096, 4096}, Extent{0, 0}}) {
    o.page = page;
    const PackResult r = pack(items, o);
    ASSERT_EQ(r.pages.size(), 1u);
    EXPECT_EQ(r.pages[0].area(), 256 * 256);
  }
}

TEST(PackRects, EnormousItemsStayInTheOpenPage) {
  // Three of these above each other would exceed 2^31 texels. The packer counts cells, but texels
  // must fit, too.
  std::vector<Extent> items(4, Extent{1000000000, 7});
  items.push_back({2, 3});
  PackOptions o;
  o.page = {10, 0};
  o.allow_rotation = true;
  o.alignment = 4;
  o.padding = 1;
  for (PackPreset preset : {PackPreset::fast, PackPreset::standard, PackPreset::best}) {
    o.preset = preset;
    o.effort = 20;
    const Result<PackResult> r = pack_rects(items, o, {});
    ASSERT_TRUE(r.ok());
    EXPECT_FALSE(r->unplaced.empty());
    EXPECT_EQ(test::check_layout(items, r->placements, r->pages, o), "");
  }
}

// Sides above 2^30 texels cannot be rounded up to a power of two in 32 bits.
TEST(PackRects, OpenSidesEndAtTheLongestPage) {
  const std::vector<Extent> items{{5, (1 << 30) - 3}, {7, 9}};
  PackOptions o;
  o.power_of_two = true;
  o.border = 2;
  for (const Extent page : {Extent{16, 0}, Extent{0, 0}}) {
    o.page = page;
    const Result<PackResult> r = pack_rects(items, o, {});
    ASSERT_TRUE(r.ok()) << r.status().message();
    ASSERT_EQ(r->unplaced.size(), 1u);
    EXPECT_EQ(r->unplaced[0].item, 0u);
    EXPECT_EQ(r->unplaced[0].reason, UnplacedReason::too_large);
    EXPECT_EQ(r->pages[0].height, 16);
  }
}

}  // namespace
}  // namespace atlas
