// A preset that takes longer packs no worse, and limits that leave items out leave out few.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "libatlas/pack/layout.h"
#include "libatlas/pack/rectangles/engines.h"
#include "tests/pack/packed.h"

namespace atlas {
namespace {

constexpr PackPreset kAllPresets[] = {PackPreset::fast, PackPreset::standard, PackPreset::best};

using test::packed;

PackOptions with(PackPreset preset, PackOptions options) {
  options.preset = preset;
  options.effort = 1000;
  options.time_budget = std::numeric_limits<double>::infinity();
  return options;
}

std::int64_t texels(const PackResult& r) {
  std::int64_t sum = 0;
  for (const Extent& page : r.pages) sum += page.area();
  return sum;
}

TEST(Presets, TimesOfAnInfiniteBudgetAreInfinite) {
  const std::vector<Extent> items(20, Extent{3, 5});
  for (const bool turned : {false, true})
    for (const bool strip : {false, true})
      for (const std::uint64_t effort : {0, 1000}) {
        pack::Problem problem;
        problem.items = items;
        problem.page = {16, 16};
        problem.allow_rotation = turned;
        PackOptions o = with(PackPreset::best, {});
        o.effort = effort;
        const pack::SearchLimits l = pack::limits_for(problem, o, strip);
        EXPECT_TRUE(std::isinf(l.seconds));
        for (const double s : {l.join_seconds, l.beam_seconds, l.unturned_seconds})
          EXPECT_FALSE(std::isnan(s));
      }
}

TEST(Presets, AStripIsNoHigherThanWithFast) {
  const std::vector<Extent> items{{3, 9}, {2, 3}, {1, 3}, {1, 10}, {1, 8}, {1, 10}, {3, 4}};
  PackOptions o;
  o.page = {4, 0};
  for (const PackPreset preset : kAllPresets)
    EXPECT_EQ(packed(items, with(preset, o)).pages.at(0).height, 21);
}

// 2^30 texels are the largest height.
TEST(Presets, AStripThatIsTooLowForAllItemsHoldsSome) {
  const std::vector<Extent> items(3, Extent{1000, 500'000'000});
  PackOptions o;
  o.page = {1000, 0};
  for (const PackPreset preset : kAllPresets)
    for (const bool turned : {false, true}) {
      o.allow_rotation = turned;
      const PackResult r = packed(items, with(preset, o));
      ASSERT_EQ(r.unplaced.size(), 1u);
      EXPECT_EQ(r.unplaced[0].reason, UnplacedReason::no_room);
      EXPECT_EQ(r.placed_area, 1'000'000'000'000);
    }
}

TEST(Presets, CroppedPagesAreNoLargerThanWithFast) {
  PackOptions o;
  o.page = {23, 1573};
  o.padding = 4;
  o.crop = o.allow_rotation = true;
  const std::vector<Extent> tall{{5, 72},  {1, 748},  {2, 711},  {20, 350}, {2, 604},
                                 {8, 943}, {16, 883}, {3, 1076}, {1, 1197}, {4, 1242}};
  const std::int64_t least = texels(packed(tall, with(PackPreset::fast, o)));
  EXPECT_LE(texels(packed(tall, with(PackPreset::standard, o))), least);
  EXPECT_LE(texels(packed(tall, with(PackPreset::best, o))), least);

  // Items that end before their cells of four texels do.
  const std::vector<Extent> small{{10, 2}, {1, 2}, {4, 2}, {4, 2}, {9, 2},
                                  {8, 1},  {6, 2}, {8, 1}, {1, 2}};
  o.page = {19, 19};
  o.padding = 3;
  o.alignment = 4;
  o.square = true;
  EXPECT_LE(texels(packed(small, with(PackPreset::standard, o))),
            texels(packed(small, with(PackPreset::fast, o))));

  test::Noise noise{11};
  for (int round = 0; round < 60; ++round) {
    const std::int32_t side = noise.in(12, 40);
    std::vector<Extent> items(static_cast<std::size_t>(noise.in(2, 14)));
    for (Extent& e : items) e = {noise.in(1, side / 2), noise.in(1, side / 2)};
    o.page = {side, side};
    o.padding = noise.in(0, 3);
    o.alignment = noise.in(1, 4);
    o.square = noise.in(0, 1);
    o.allow_rotation = noise.in(0, 1);
    const PackResult fast = packed(items, with(PackPreset::fast, o));
    const PackResult standard = packed(items, with(PackPreset::standard, o));
    ASSERT_LE(standard.pages.size(), fast.pages.size()) << "round " << round;
    if (standard.pages.size() == fast.pages.size()) {
      ASSERT_LE(texels(standard), texels(fast)) << "round " << round;
    }
  }
}

// Whether the free texels of the pages hold the item.
bool has_room(Extent item, const std::vector<Extent>& items, const PackResult& r) {
  for (std::uint32_t page = 0; page < r.pages.size(); ++page) {
    pack::FreeRects free(r.pages[page]);
    for (std::size_t i = 0; i < items.size(); ++i) {
      const Placement& p = r.placements[i];
      if (p.page == page) free.place({p.x, p.y, items[i].width, items[i].height});
    }
    pack::Spot spot;
    if (free.find(item, false, pack::PlaceRule::bottom_left, spot)) return true;
  }
  return false;
}

TEST(Presets, ItemsLeftOutHaveNoRoomAndAreNoMoreThanWithFast) {
  test::Noise noise{5};
  PackOptions o;
  o.page = {256, 128};
  for (int round = 0; round < 200; ++round) {
    std::vector<Extent> items(30);
    for (Extent& e : items) e = {noise.in(1, 120), noise.in(1, 80)};
    o.max_pages = static_cast<std::uint32_t>(noise.in(1, 3));
    const PackResult fast = packed(items, with(PackPreset::fast, o));
    for (const PackPreset preset : {PackPreset::standard, PackPreset::best}) {
      const PackResult r = packed(items, with(preset, o));
      ASSERT_LE(r.unplaced.size(), fast.unplaced.size()) << "round " << round;
      for (const UnplacedItem& u : r.unplaced)
        ASSERT_FALSE(has_room(items[u.item], items, r)) << "round " << round;
    }
  }
}

// The areas are beyond the integers that a double holds, and their rounded sum exceeds the page's.
TEST(Presets, TheBoundOfOneEnormousFullPageIsOne) {
  constexpr std::int32_t kSide = (1 << 30) - 1;
  std::vector<Extent> items;
  for (const std::int32_t width : {67760437, 752336317, 41328795, 212316274})
    items.push_back({width, kSide});
  PackOptions o;
  o.page = {kSide, kSide};
  for (const PackPreset preset : kAllPresets) {
    const PackResult r = packed(items, with(preset, o));
    EXPECT_EQ(r.pages.size(), 1u);
    EXPECT_EQ(r.page_lower_bound, 1u);
  }
}

// A page of 8 x 8 has the area of four items of 4 x 4.
TEST(Presets, TheBoundIsNeverBelowThatOfTheArea) {
  PackOptions o;
  o.page = {8, 8};
  const PinnedRect pinned{0, {0, 0, 4, 4}};
  for (const PackPreset preset : kAllPresets)
    for (const bool pin : {false, true}) {
      o.pinned = std::span(&pinned, pin ? 1 : 0);
      EXPECT_EQ(packed(std::vector<Extent>(9, {4, 4}), with(preset, o)).page_lower_bound, 3u);
      EXPECT_EQ(packed(std::vector<Extent>(8, {4, 4}), with(preset, o)).page_lower_bound, 2u);
      EXPECT_EQ(packed({{1, 1}}, with(preset, o)).page_lower_bound, 1u);
    }
}

TEST(Presets, ItemsWithoutAreaNeedACornerOnThePage) {
  PackOptions o;
  o.page = {10, 10};
  o.crop = true;
  for (const bool far : {true, false}) {
    o.border = far ? 8 : 1;
    o.alignment = far ? 1 : 16;
    const PackResult r = packed({{0, 5}}, o);
    ASSERT_EQ(r.unplaced.size(), 1u);
    EXPECT_EQ(r.unplaced[0].reason, UnplacedReason::too_large);
    Result<AtlasLayout> layout = AtlasLayout::create(o);
    ASSERT_TRUE(layout.ok());
    EXPECT_EQ(layout->insert({0, 5}).status().code(), ErrorCode::no_solution);
  }
  // Where there is one, the page has a texel.
  o.border = 0;
  o.alignment = 1;
  EXPECT_EQ(packed({{0, 5}}, o).pages, std::vector<Extent>(1, Extent{1, 1}));
  o.border = 5;
  EXPECT_EQ(packed({{0, 5}}, o).pages, std::vector<Extent>(1, Extent{10, 10}));
}

TEST(Presets, EffortIsForBestOnly) {
  test::Noise noise{3};
  std::vector<Extent> items(12);
  for (Extent& e : items) e = {noise.in(4, 60), noise.in(4, 60)};
  PackOptions o;
  o.crop = true;
  const PackResult plain = packed(items, o);
  o.effort = 1;
  EXPECT_EQ(packed(items, o).placements, plain.placements);
  EXPECT_EQ(packed(items, o).layouts_tried, plain.layouts_tried);
}

// Strips of several widths are tried for a cropped page, and each has a share of the effort.
TEST(Presets, LayoutsOfCroppedPagesAreCountedOnce) {
  test::Noise noise{3};
  std::vector<Extent> items(40);
  for (Extent& e : items) e = {noise.in(4, 60), noise.in(4, 60)};
  PackOptions o = with(PackPreset::best, {});
  o.crop = true;
  o.effort = 20'000;
  EXPECT_LT(packed(items, o).layouts_tried, 22'000u);
}

}  // namespace
}  // namespace atlas
