// Being allowed to turn items must never cost room, and long items lie where lying saves height.
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "tests/support/layout_checks.h"

namespace atlas {
namespace {

std::int32_t height_of(const std::vector<Extent>& items, const PackOptions& options) {
  const Result<PackResult> r = pack_rects(items, options, {});
  EXPECT_TRUE(r.ok()) << r.status().message();
  if (!r.ok()) return 0;
  EXPECT_TRUE(r->unplaced.empty());
  EXPECT_EQ(test::check_layout(items, r->placements, r->pages, options), "");
  return r->pages[0].height;
}

// Bars of a length and a thickness within these bounds, half of which stand.
struct Bars {
  std::size_t count;
  Extent length, thickness;  // least and greatest
  std::int32_t strip;        // a width of it
};

std::vector<Extent> make_bars(test::Noise& noise, const Bars& bars) {
  std::vector<Extent> items(bars.count);
  for (Extent& e : items) {
    e = {noise.in(bars.length.width, bars.length.height),
         noise.in(bars.thickness.width, bars.thickness.height)};
    if (noise.in(0, 1)) std::swap(e.width, e.height);
  }
  return items;
}

PackOptions turned_strip(std::int32_t width) {
  PackOptions o;
  o.page = {width, 0};
  o.allow_rotation = true;
  return o;
}

// The height of all bars on top of each other, or of as many columns of them as the strip has room
// for: a layout that exists, made without any packer.
std::int32_t stacked(std::vector<Extent> bars, std::int32_t width) {
  std::int32_t longest = 0;
  for (Extent& e : bars) {
    if (e.height > e.width) std::swap(e.width, e.height);
    longest = std::max(longest, e.width);
  }
  std::vector<std::int32_t> columns(static_cast<std::size_t>(width / longest));
  for (const Extent& e : bars) *std::min_element(columns.begin(), columns.end()) += e.height;
  return *std::max_element(columns.begin(), columns.end());
}

TEST(TurnedStrips, BarsAreNoHigherThanStacked) {
  test::Noise noise{21};
  const Bars sets[] = {{40, {800, 840}, {10, 10}, 1024},
                       {40, {200, 1000}, {4, 24}, 1024},
                       {100, {100, 900}, {2, 10}, 920},
                       {100, {300, 310}, {10, 20}, 640},
                       {900, {300, 310}, {10, 20}, 1900}};
  for (const Bars& bars : sets) {
    const std::vector<Extent> items = make_bars(noise, bars);
    for (const PackPreset preset : {PackPreset::standard, PackPreset::best}) {
      PackOptions o = turned_strip(bars.strip);
      o.preset = preset;
      o.effort = 300;
      o.time_budget = 1e9;
      EXPECT_LE(height_of(items, o), stacked(items, bars.strip)) << bars.strip;
    }
  }
}

// More bars than are searched, which all have about the same length, so that each is best turned as
// its place demands.
TEST(TurnedStrips, ManyBarsFillTheStrip) {
  test::Noise noise{22};
  const std::vector<Extent> items = make_bars(noise, {1500, {300, 310}, {10, 20}, 0});
  double area = 0;
  for (const Extent& e : items) area += double(e.area());
  EXPECT_LE(height_of(items, turned_strip(2701)), area / 2701 / 0.97);
}

// Sets that without turns are packed without any waste, and sets of all kinds.
TEST(TurnedStrips, AreNeverHigherThanWithoutTurns) {
  test::Noise noise{23};
  for (int round = 0; round < 24; ++round) {
    std::vector<Extent> items;
    if (round % 3 == 0)
      items = make_bars(noise, {std::size_t(noise.in(10, 60)), {20, 150}, {2, 30}, 0});
    else if (round % 3 == 1)  // four columns of equal height
      for (const std::int32_t width : {20, 40, 60, 80})
        for (std::int32_t y = 0, next = 0; y < 120; y = next) {
          next = std::min(120, y + noise.in(5, 60));
          items.push_back({width, next - y});
        }
    else
      items = test::log_normal_rects(std::size_t(noise.in(10, 80)), noise.next());
    std::int32_t widest = 200;
    for (const Extent& e : items) widest = std::max(widest, e.width);
    PackOptions o = turned_strip(widest);
    const std::int32_t turned = height_of(items, o);
    o.allow_rotation = false;
    EXPECT_LE(turned, height_of(items, o)) << round;
  }
}

TEST(TurnedStrips, AreTheSameForEveryThreadCount) {
  test::Noise noise{24};
  const std::vector<Extent> items = make_bars(noise, {60, {50, 300}, {4, 24}, 0});
  for (const PackPreset preset : {PackPreset::standard, PackPreset::best}) {
    PackOptions o = turned_strip(400);
    o.preset = preset;
    o.effort = 3000;
    o.time_budget = 1e9;
    Context one, four;
    one.threads = 1;
    four.threads = 4;
    const Result<PackResult> a = pack_rects(items, o, one), b = pack_rects(items, o, four);
    ASSERT_TRUE(a.ok() && b.ok());
    EXPECT_EQ(a->placements, b->placements);
  }
}

// Cropped pages of all presets, of one page and of several, with the largest page of each set.
TEST(TurnedPages, AreNeverLargerThanWithoutTurns) {
  test::Noise noise{25};
  for (int round = 0; round < 10; ++round) {
    const std::vector<Extent> items =
        round % 2 ? make_bars(noise, {std::size_t(noise.in(10, 40)), {20, 150}, {2, 30}, 0})
                  : test::log_normal_rects(std::size_t(noise.in(10, 40)), noise.next());
    std::int32_t longest = 0;
    for (const Extent& e : items) longest = std::max({longest, e.width, e.height});
    PackOptions o;
    o.crop = true;
    o.preset = round % 3 ? PackPreset::standard : PackPreset::fast;
    o.page = round % 4 < 2 ? Extent{4096, 4096} : Extent{longest, longest};
    o.square = round % 5 == 4;
    const auto texels = [&](bool turn) {
      o.allow_rotation = turn;
      const Result<PackResult> r = pack_rects(items, o, {});
      EXPECT_TRUE(r.ok() && r->unplaced.empty());
      EXPECT_EQ(test::check_layout(items, r->placements, r->pages, o), "");
      std::int64_t sum = 0;
      for (const Extent& page : r->pages) sum += page.area();
      return std::pair(r->pages.size(), sum);
    };
    EXPECT_LE(texels(true), texels(false)) << round;
  }
}

}  // namespace
}  // namespace atlas
