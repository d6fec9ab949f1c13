// Masks that slide over a page, compared with the page cell by cell.
#include "libatlas/pack/nesting/slide.h"

#include <gtest/gtest.h>

#include <set>
#include <utility>

#include "tests/support/layout_checks.h"

namespace atlas {
namespace {

using namespace pack;

using Cells = std::set<std::pair<int, int>>;

Cells cells_of(const SlidingMask& m, BitPage::Place at) {
  Cells cells;
  for (int r = 0; r < m.mask->height; ++r)
    for (const pack::Run& run : m.mask->row(r))
      for (int x = run.begin; x < run.end; ++x) cells.emplace(at.x + x, at.y + r);
  return cells;
}

// Returns whether one of the cells lies left of the page, below it, or on another mask.
bool meets(const Cells& cells, std::size_t self, const std::vector<SlidingMask>& masks) {
  for (const auto& [x, y] : cells)
    if (x < 0 || y < 0) return true;
  for (std::size_t j = 0; j < masks.size(); ++j) {
    if (j == self) continue;
    for (const auto& cell : cells_of(masks[j], masks[j].at))
      if (cells.contains(cell)) return true;
  }
  return false;
}

TEST(Slide, MasksGoAsFarAsTheyCanAndNoFarther) {
  test::Noise noise{7};
  for (int round = 0; round < 20; ++round) {
    std::vector<Mask> shapes;
    for (int i = 0; i < 12; ++i) {
      RasterOptions o;
      o.padding = 0;
      Vec2d origin;
      shapes.push_back(
          rasterize(outline_of({test::blob(noise, 10, noise.in(3, 8)), {}}), o, origin));
    }
    PlainPage page(90, 90);
    std::vector<SlidingMask> masks;
    for (std::uint32_t i = 0; i < shapes.size(); ++i) {  // a grid of 4 x 3
      masks.push_back({&shapes[i], {int(i % 4) * 22 + round % 3, int(i / 4) * 25 + 3}, i});
      page.put(shapes[i], masks.back().at);
    }
    const BitPage::Place step = round % 2 == 0 ? BitPage::Place{0, -1} : BitPage::Place{-1, 0};
    const std::vector<SlidingMask> before = masks;
    EXPECT_TRUE(slide(step, page, masks));
    while (slide(step, page, masks)) {
    }
    for (std::size_t k = 0; k < masks.size(); ++k) {
      const SlidingMask& m = masks[k];
      EXPECT_FALSE(meets(cells_of(m, m.at), k, masks));
      EXPECT_TRUE(meets(cells_of(m, {m.at.x + step.x, m.at.y + step.y}), k, masks));
      const BitPage::Place from = before[m.chart].at;
      EXPECT_EQ(step.x == 0 ? m.at.x : m.at.y, step.x == 0 ? from.x : from.y);
      for (const auto& [x, y] : cells_of(m, m.at)) {  // the page must know where they are
        Mask one;
        one.width = one.height = 1;
        one.first = {0, 1};
        one.runs = {{0, 1}};
        one.cells = 1;
        EXPECT_FALSE(page.is_free(one, {x, y}));
      }
    }
  }
}

}  // namespace
}  // namespace atlas
