// Pages that can be saved are saved, and the sides of pages fit the blocks of compressed textures.
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "tests/pack/packed.h"

namespace atlas {
namespace {

using test::packed;

// Cuts a page into items by guillotine cuts, always through the largest part.
std::vector<Extent> cut_page(test::Noise& noise, std::int32_t side, std::size_t count) {
  std::vector<Extent> parts{{side, side}};
  while (parts.size() < count) {
    const auto largest =
        std::max_element(parts.begin(), parts.end(),
                         [](const Extent& a, const Extent& b) { return a.area() < b.area(); });
    Extent rest = *largest;
    std::int32_t Extent::*across =
        largest->width > largest->height ? &Extent::width : &Extent::height;
    (*largest).*across = noise.in(rest.*across / 4, rest.*across * 3 / 4);
    rest.*across -= (*largest).*across;
    parts.push_back(rest);
  }
  return parts;
}

// Items that fill a page without any waste. A search over pages finds few of these layouts.
TEST(SavedPages, ASetThatFillsOnePageMostlyGetsOne) {
  test::Noise noise{2};
  int one = 0, limited = 0;
  for (int round = 0; round < 20; ++round) {
    const std::vector<Extent> items = cut_page(noise, 256, 26);
    PackOptions o;
    o.page = {256, 256};
    one += packed(items, o).pages.size() == 1;
    o.max_pages = 1;
    limited += packed(items, o).unplaced.empty();
  }
  EXPECT_GE(one, 12);
  EXPECT_EQ(limited, one);
}

// The same beside an item that takes nearly a page.
TEST(SavedPages, TheLastPageBeforeTheLimitHoldsWhatIsLeft) {
  test::Noise noise{4};
  int all = 0;
  for (int round = 0; round < 20; ++round) {
    std::vector<Extent> items{{250, 250}};  // has a page of its own
    for (const Extent& e : cut_page(noise, 256, 26)) items.push_back(e);
    PackOptions o;
    o.page = {256, 256};
    o.max_pages = 2;
    all += packed(items, o).unplaced.empty();
  }
  EXPECT_GE(all, 12);
}

TEST(SavedPages, DefaultNeedsNoMoreThanFast) {
  test::Noise noise{6};
  for (int round = 0; round < 150; ++round) {
    std::vector<Extent> items(static_cast<std::size_t>(noise.in(50, 300)));
    for (Extent& e : items) {
      e = {noise.in(50, 300), noise.in(4, 24)};
      if (noise.in(0, 1)) std::swap(e.width, e.height);
    }
    PackOptions o;
    o.page = {320, noise.in(0, 1) ? 320 : 100};
    o.allow_rotation = true;
    o.preset = PackPreset::fast;
    const std::size_t fast = packed(items, o).pages.size();
    o.preset = PackPreset::standard;
    EXPECT_LE(packed(items, o).pages.size(), fast) << round;
    o.preset = PackPreset::best;
    o.effort = 40;
    o.time_budget = 1e9;
    EXPECT_LE(packed(items, o).pages.size(), fast) << round;
  }
}

TEST(PageSides, AreMultiplesOfTheAlignment) {
  test::Noise noise{8};
  for (int round = 0; round < 40; ++round) {
    std::vector<Extent> items(static_cast<std::size_t>(noise.in(1, 15)));
    for (Extent& e : items) e = {noise.in(1, 60), noise.in(1, 60)};
    PackOptions o;
    o.alignment = round % 2 ? 4 : 6;
    o.padding = noise.in(0, 3);
    o.border = noise.in(0, 3);
    o.crop = true;
    o.square = round % 3 == 0;
    o.allow_rotation = noise.in(0, 1);
    if (round % 5 == 1) o.page = {120, 0};
    if (round % 5 == 2) o.page = {0, 0};
    if (round % 5 == 3) o.page = {120, 120};
    for (const Extent& page : packed(items, o).pages) {
      EXPECT_EQ(page.width % o.alignment, 0) << round;
      EXPECT_EQ(page.height % o.alignment, 0) << round;
    }
  }
  // The largest page has no room for whole blocks.
  PackOptions o;
  o.page = {63, 63};
  o.alignment = 4;
  o.crop = true;
  o.padding = 3;
  EXPECT_EQ(packed({{61, 5}}, o).pages, (std::vector<Extent>{{61, 8}}));
}

}  // namespace
}  // namespace atlas
