// Cropped pages, of few items and of items much longer than others.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "libatlas/pack/rectangles/pull_in.h"
#include "tests/support/layout_checks.h"

namespace atlas {
namespace {

constexpr PackPreset kPresets[] = {PackPreset::fast, PackPreset::standard, PackPreset::best};

PackOptions cropped(PackPreset preset) {
  PackOptions o;
  o.crop = true;
  o.preset = preset;
  o.effort = 500;
  return o;
}

// Returns the page of a layout that has one, after checking the layout.
Extent page_of(const std::vector<Extent>& items, const PackOptions& options) {
  const Result<PackResult> r = pack_rects(items, options, {});
  EXPECT_TRUE(r.ok()) << r.status().message();
  if (!r.ok()) return {};
  EXPECT_TRUE(r->unplaced.empty());
  EXPECT_EQ(r->pages.size(), 1u);
  EXPECT_EQ(test::check_layout(items, r->placements, r->pages, options), "");
  return r->pages.empty() ? Extent{} : r->pages[0];
}

// The best slicing layouts of few items: all that arise from putting layouts of smaller sets beside
// or above each other, by trying all of them.
class Slicings {
 public:
  Slicings(const std::vector<Extent>& items, bool turn) : best_(std::size_t{1} << items.size()) {
    for (std::size_t set = 1; set < best_.size(); ++set) {
      for (std::size_t i = 0; i < items.size(); ++i)
        if (set == std::size_t{1} << i) {
          add(set, items[i]);
          if (turn) add(set, {items[i].height, items[i].width});
        }
      for (std::size_t part = (set - 1) & set; part > 0; part = (part - 1) & set)
        for (const Extent a : best_[part])
          for (const Extent b : best_[set ^ part]) {
            add(set, {a.width + b.width, std::max(a.height, b.height)});
            add(set, {std::max(a.width, b.width), a.height + b.height});
          }
    }
  }

  // Returns the smallest area of all items on a page no larger than `most`.
  std::int64_t area(Extent most) const {
    std::int64_t least = std::numeric_limits<std::int64_t>::max();
    for (const Extent e : best_.back())
      if (e.width <= most.width && e.height <= most.height) least = std::min(least, e.area());
    return least;
  }

 private:
  // Keeps a size unless another one is no larger in both directions.
  void add(std::size_t set, Extent e) {
    std::vector<Extent>& sizes = best_[set];
    const auto holds = [](Extent a, Extent b) {
      return a.width >= b.width && a.height >= b.height;
    };
    if (std::any_of(sizes.begin(), sizes.end(), [&](Extent s) { return holds(e, s); })) return;
    std::erase_if(sizes, [&](Extent s) { return holds(s, e); });
    sizes.push_back(e);
  }

  std::vector<std::vector<Extent>> best_;  // by set of items
};

// A few items of which some are fifty times as long as wide.
std::vector<Extent> few_items(test::Noise& noise) {
  std::vector<Extent> items(static_cast<std::size_t>(noise.in(2, 6)));
  for (Extent& e : items) {
    e = {noise.in(4, 60), noise.in(4, 60)};
    if (noise.in(0, 2) > 0) continue;
    e = {noise.in(4, 30), noise.in(300, 1500)};
    if (noise.in(0, 1)) std::swap(e.width, e.height);
  }
  return items;
}

TEST(CroppedPages, OfALongItemAreNoLongerThanIt) {
  for (const PackPreset preset : kPresets) {
    const PackOptions o = cropped(preset);
    EXPECT_LE(page_of({{20, 1000}, {5, 5}}, o).area(), 20 * 1005);
    EXPECT_LE(page_of({{1000, 20}, {5, 5}}, o).area(), 20 * 1005);
    std::vector<Extent> icons(6, {32, 32});
    icons.push_back({16, 900});
    EXPECT_LE(page_of(icons, o).area(), 50 * 900);
  }
}

TEST(CroppedPages, OfFewItemsAreAsSmallAsTheBestSlicing) {
  test::Noise noise{3};
  double ratios = 0, count = 0;
  for (const bool turn : {false, true})
    for (int round = 0; round < 40; ++round) {
      const std::vector<Extent> items = few_items(noise);
      const Slicings slicings(items, turn);
      for (const PackPreset preset : kPresets) {
        PackOptions o = cropped(preset);
        o.allow_rotation = turn;
        o.page = round % 2 ? Extent{2048, 2048} : Extent{0, 0};
        const Extent most = round % 2 ? o.page : Extent{1 << 20, 1 << 20};
        const std::int64_t area = slicings.area(most);
        if (area == std::numeric_limits<std::int64_t>::max()) continue;
        const double ratio = double(page_of(items, o).area()) / double(area);
        EXPECT_LE(ratio, 1.1) << turn << " " << round;
        ratios += ratio;
        ++count;
      }
    }
  EXPECT_GE(count, 200);
  EXPECT_LE(ratios / count, 1.005);
}

// Sets of all sizes that are searched in different ways, each with an item that is longer than the
// side of their square.
TEST(CroppedPages, OfManyItemsAndALongOneAreNarrow) {
  test::Noise noise{5};
  for (const int count : {40, 300, 3000}) {
    const std::int32_t longest = count * 12;
    std::vector<Extent> items(static_cast<std::size_t>(count));
    std::int64_t area = 20 * longest;
    for (Extent& e : items) {
      e = {noise.in(4, 40), noise.in(4, 40)};
      area += e.area();
    }
    for (const bool tall : {false, true})
      for (const PackPreset preset : kPresets) {
        std::vector<Extent> all = items;
        all.push_back(tall ? Extent{20, longest} : Extent{longest, 20});
        PackOptions o = cropped(preset);
        o.page = {1 << 16, 1 << 16};
        const Extent page = page_of(all, o);
        const double fill = double(area) / double(page.area());
        EXPECT_GE(fill, preset == PackPreset::fast ? 0.7 : 0.85) << count << " " << tall;
      }
  }
}

// The items of the last of several pages get no larger page than if they were packed alone.
TEST(CroppedPages, TheLastOfSeveralIsAsSmallAsAlone) {
  test::Noise noise{31};
  for (int round = 0; round < 12; ++round) {
    std::vector<Extent> items(static_cast<std::size_t>(noise.in(40, 120)));
    for (Extent& e : items) e = {noise.in(4, 60), noise.in(4, 60)};
    PackOptions o = cropped(round % 4 ? PackPreset::standard : PackPreset::fast);
    o.page = {128, 128};
    o.allow_rotation = round % 2;
    o.power_of_two = round % 3 == 1;
    o.square = round % 3 == 2;
    const Result<PackResult> all = pack_rects(items, o, {});
    ASSERT_TRUE(all.ok() && all->unplaced.empty());
    EXPECT_EQ(test::check_layout(items, all->placements, all->pages, o), "");
    ASSERT_GT(all->pages.size(), 1u);
    std::vector<Extent> last;
    for (std::size_t i = 0; i < items.size(); ++i)
      if (all->placements[i].page + 1 == all->pages.size()) last.push_back(items[i]);
    // Alone, items that may be turned are packed without turns, too, which this page need not be.
    const double slack = o.allow_rotation ? 1.1 : 1;
    EXPECT_LE(double(all->pages.back().area()), slack * double(page_of(last, o).area())) << round;
  }
}

TEST(CroppedPages, AreTheSameForEveryThreadCount) {
  test::Noise noise{8};
  for (int round = 0; round < 10; ++round) {
    std::vector<Extent> items = few_items(noise);
    items.resize(30, {noise.in(10, 50), noise.in(10, 50)});
    const PackOptions o = cropped(PackPreset::best);
    Context context;
    context.threads = 1;
    const Result<PackResult> one = pack_rects(items, o, context);
    context.threads = 4;
    const Result<PackResult> four = pack_rects(items, o, context);
    ASSERT_TRUE(one.ok() && four.ok());
    EXPECT_EQ(one->placements, four->placements);
  }
}

// Items that lie scattered come to rest: none overlaps another, none has moved right or up, and
// each has something to its left and below it, which is looked for by comparing all pairs.
TEST(PullIn, ItemsComeToRestAtOthers) {
  test::Noise noise{13};
  for (int round = 0; round < 50; ++round) {
    std::vector<Extent> items;
    pack::Layout layout;
    for (std::int32_t k = 0; k < 30; ++k) {  // each in a cell of a grid of its own
      items.push_back({noise.in(1, 30), noise.in(1, 30)});
      layout.placements.push_back({std::uint32_t(k % 2), k % 6 * 60 + noise.in(0, 30),
                                   k / 6 * 60 + noise.in(0, 30), noise.in(0, 1) == 1});
    }
    pack::Problem problem;
    problem.items = items;
    const std::vector<Placement> before = layout.placements;
    pack::pull_in(problem, layout);
    PackOptions o;
    o.allow_rotation = true;
    const std::vector<Extent> pages(2, {400, 400});
    ASSERT_EQ(test::check_layout(items, layout.placements, pages, o), "");
    const auto box = [&](std::size_t i) {
      const Placement& p = layout.placements[i];
      const Extent e = p.rotated ? Extent{items[i].height, items[i].width} : items[i];
      return Rect{p.x, p.y, e.width, e.height};
    };
    for (std::size_t i = 0; i < items.size(); ++i) {
      const Rect a = box(i);
      EXPECT_LE(a.x, before[i].x);
      EXPECT_LE(a.y, before[i].y);
      bool held_left = a.x == 0, held_below = a.y == 0;
      for (std::size_t j = 0; j < items.size(); ++j) {
        const Rect b = box(j);
        if (j == i || layout.placements[j].page != layout.placements[i].page) continue;
        held_left |= b.right() == a.x && b.y < a.top() && a.y < b.top();
        held_below |= b.top() == a.y && b.x < a.right() && a.x < b.right();
      }
      EXPECT_TRUE(held_left && held_below) << "round " << round << ", item " << i;
    }
  }
}

}  // namespace
}  // namespace atlas
