// Pieces that may overlap for a while: their overlaps counted cell by cell, and layouts without
// any.
#include "libatlas/pack/nesting/overlap_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <utility>
#include <vector>

#include "libatlas/pack/nesting/nudge.h"
#include "libatlas/pack/nesting/pair_overlaps.h"
#include "libatlas/pack/nesting/weight_map.h"
#include "tests/support/layout_checks.h"

namespace atlas {
namespace {

using namespace pack;
using Cell = std::pair<std::int32_t, std::int32_t>;

std::vector<ChartOutline> blobs(test::Noise& noise, int count) {
  std::vector<ChartOutline> outlines;
  for (int k = 0; k < count; ++k)
    outlines.push_back(
        outline_of({test::blob(noise, 4.0 + 20 * noise.unit(), noise.in(3, 9)), {}}));
  return outlines;
}

std::vector<Piece> pieces_of(const std::vector<ChartOutline>& outlines) {
  PieceOptions options;
  options.directions = 8;
  return make_pieces(outlines, options, {});
}

std::vector<Cell> cells_of(const Mask& mask, BitPage::Place at) {
  std::vector<Cell> cells;
  for (std::int32_t r = 0; r < mask.height; ++r)
    for (const pack::Run& run : mask.row(r))
      for (std::int32_t x = run.begin; x < run.end; ++x) cells.emplace_back(at.x + x, at.y + r);
  return cells;
}

// Returns whether the masks lie within a page of this size, and no cell belongs to two of them.
bool lie_apart(const std::vector<PlacedMask>& masks, std::int32_t width, std::int32_t height) {
  std::map<Cell, int> owners;
  for (const PlacedMask& m : masks)
    for (const Cell& cell : cells_of(*m.mask, m.at)) {
      const bool inside =
          cell.first >= 0 && cell.first < width && cell.second >= 0 && cell.second < height;
      if (!inside || ++owners[cell] > 1) return false;
    }
  return true;
}

std::vector<PlacedMask> masks_of(const std::vector<Piece>& pieces, const Nest& nest) {
  std::vector<PlacedMask> masks;
  for (std::size_t i = 0; i < pieces.size(); ++i)
    masks.push_back({&pieces[i].masks[nest.places[i].direction], nest.places[i].at});
  return masks;
}

TEST(WeightMap, PlacesWeighWhatTheirCellsDo) {
  test::Noise noise{3};
  const std::vector<Piece> pieces = pieces_of(blobs(noise, 12));
  constexpr std::int32_t kWidth = 101, kHeight = 93;
  WeightMap map(kWidth, kHeight);
  for (int round = 0; round < 3; ++round) {
    map.clear();
    std::map<Cell, std::int64_t> weights;
    for (const Piece& piece : pieces) {
      const Mask& mask = piece.masks[std::size_t(noise.in(0, 7))];
      const BitPage::Place at{noise.in(0, kWidth - mask.width), noise.in(0, kHeight - mask.height)};
      const std::int32_t weight = noise.in(1, 4096);
      map.add(mask, at, weight);
      for (const Cell& cell : cells_of(mask, at)) weights[cell] += weight;
    }
    map.sum();
    for (int k = 0; k < 200; ++k) {
      const Mask& mask = pieces[std::size_t(noise.in(0, 11))].masks[std::size_t(noise.in(0, 7))];
      const std::int32_t top = kHeight - mask.height;
      const BitPage::Place lowest{noise.in(0, kWidth - mask.width), noise.in(0, top)};
      const std::int32_t count = noise.in(1, std::min(WeightMap::kColumn, top - lowest.y + 1));
      std::vector<std::int64_t> column(std::size_t(count), 0);
      for (std::int32_t dy = 0; dy < count; ++dy)
        for (const Cell& cell : cells_of(mask, {lowest.x, lowest.y + dy}))
          column[std::size_t(dy)] += weights[cell];
      const auto least = std::min_element(column.begin(), column.end());
      const auto exactly = static_cast<std::int32_t>(*least);
      const WeightMap::Lightest found = map.weigh(mask, lowest, count, exactly);
      EXPECT_EQ(found.weight, exactly);
      EXPECT_EQ(found.at, (BitPage::Place{lowest.x, lowest.y + int(least - column.begin())}));
      if (exactly > 0) {
        EXPECT_GE(map.weigh(mask, lowest, count, exactly - 1).weight, exactly);
      }
    }
  }
}

TEST(PairOverlaps, AreThoseCountedCellByCell) {
  test::Noise noise{5};
  const std::vector<Piece> pieces = pieces_of(blobs(noise, 9));
  std::vector<PlacedMask> masks;
  for (const Piece& p : pieces) masks.push_back({&p.masks[0], {noise.in(0, 60), noise.in(0, 60)}});
  masks.push_back({});  // takes no part
  PairOverlaps pairs(masks);
  EXPECT_EQ(pairs.taking_part().size(), pieces.size());
  pairs.reset();
  for (int round = 0; round < 20; ++round) {
    std::map<Cell, std::vector<std::size_t>> owners;
    for (std::size_t i = 0; i < pieces.size(); ++i)
      for (const Cell& cell : cells_of(*masks[i].mask, masks[i].at)) owners[cell].push_back(i);
    std::int64_t total = 0;
    std::vector<bool> overlaps(pieces.size(), false);
    for (const auto& [cell, there] : owners) {
      total += std::int64_t(there.size() * (there.size() - 1) / 2);
      if (there.size() > 1)
        for (const std::size_t i : there) overlaps[i] = true;
    }
    EXPECT_EQ(pairs.total(), total);
    for (std::uint32_t i = 0; i < pieces.size(); ++i) EXPECT_EQ(pairs.overlaps(i), overlaps[i]);
    const auto moved = static_cast<std::uint32_t>(noise.in(0, 8));
    masks[moved] = {&pieces[moved].masks[std::size_t(noise.in(0, 7))],
                    {noise.in(0, 60), noise.in(0, 60)}};
    pairs.measure(moved);
  }
}

// Of two overlaps, the larger one comes to weigh more. Both fall back when they are gone.
TEST(PairOverlaps, WeightsOfThoseThatPersistGrow) {
  const std::vector<Vec2d> box{{0, 0}, {20, 0}, {20, 20}, {0, 0}, {20, 20}, {0, 20}};
  const std::vector<Piece> pieces = pieces_of({outline_of({box, {}})});
  const Mask& mask = pieces[0].masks[0];
  std::vector<PlacedMask> masks{{&mask, {0, 0}},
                                {&mask, {mask.width - 2, 0}},
                                {&mask, {0, mask.height - 4}},
                                {&mask, {0, 10 * mask.height}}};
  PairOverlaps pairs(masks);
  pairs.reset();
  for (int round = 0; round < 4; ++round) pairs.raise_weights();
  EXPECT_GT(pairs.weight(0, 2), pairs.weight(0, 1));
  EXPECT_GT(pairs.weight(0, 1), PairOverlaps::kLeastWeight);
  EXPECT_EQ(pairs.weight(2, 0), pairs.weight(0, 2));
  EXPECT_EQ(pairs.weight(0, 3), PairOverlaps::kLeastWeight);
  for (int round = 0; round < 40; ++round) pairs.raise_weights();
  EXPECT_EQ(pairs.weight(0, 2), PairOverlaps::kMostWeight);
  masks[0].at.y = 20 * mask.height;
  pairs.measure(0);
  for (int round = 0; round < 200; ++round) pairs.raise_weights();
  EXPECT_EQ(pairs.weight(0, 2), PairOverlaps::kLeastWeight);
}

struct Searched {
  std::vector<Piece> pieces;
  Nest before, after;
  std::uint64_t work = 0;
};

Searched search_some(std::uint64_t seed, OverlapSearchOptions options, const Context& context) {
  test::Noise noise{seed};
  Searched s;
  s.pieces = pieces_of(blobs(noise, noise.in(8, 25)));
  NestSearchOptions search;
  search.width = options.width;
  search.layouts = 5;
  s.before = search_nest(s.pieces, plan_by_size(s.pieces), search, {}).nest;
  s.after = s.before;
  s.work = search_overlaps(s.pieces, options, context, s.after);
  return s;
}

TEST(OverlapSearch, MakesLayoutsLowerWithoutOverlaps) {
  int lower = 0;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    OverlapSearchOptions options;
    options.width = 130;
    options.work = 3'000'000;
    const Searched s = search_some(seed, options, {}), again = search_some(seed, options, {});
    ASSERT_TRUE(s.before.left_over.empty());
    ASSERT_LE(s.after.used_height, s.before.used_height);
    lower += s.after.used_height < s.before.used_height;
    const std::vector<PlacedMask> masks = masks_of(s.pieces, s.after);
    EXPECT_TRUE(lie_apart(masks, options.width, s.after.used_height)) << seed;
    std::int32_t top = 0;
    for (const PlacedMask& m : masks) top = std::max(top, m.at.y + m.mask->height);
    EXPECT_EQ(s.after.used_height, top);
    EXPECT_LT(s.work, 2 * options.work);
    EXPECT_EQ(s.after.places, again.after.places);
    EXPECT_EQ(s.work, again.work);
  }
  EXPECT_GE(lower, 12);
}

TEST(OverlapSearch, EndsWhenTheStripIsLowEnoughOrTheSearchIsCancelled) {
  OverlapSearchOptions options;
  options.width = 130;
  options.work = 3'000'000;
  const Searched whole = search_some(4, options, {});
  ASSERT_LT(whole.after.used_height, whole.before.used_height - 1);
  options.low_enough = whole.before.used_height - 1;
  const Searched enough = search_some(4, options, {});
  EXPECT_LE(enough.after.used_height, options.low_enough);
  EXPECT_LT(enough.work, whole.work);
  options.low_enough = whole.before.used_height;
  EXPECT_EQ(search_some(4, options, {}).after.places, whole.before.places);
  Context cancelled;
  std::atomic<bool> cancel{true};
  cancelled.cancel = &cancel;
  EXPECT_EQ(search_some(4, options, cancelled).work, 0u);
}

bool apart_by(const Extent& page, std::vector<PlacedMask>& masks, double work = 1e9) {
  return nudge_apart(page, masks, work);
}

// The masks of a sound layout are moved by up to two cells, as rounding does.
TEST(Nudge, MovesMasksApart) {
  int apart = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    OverlapSearchOptions options;
    options.width = 130;
    const Searched s = search_some(seed, options, {});
    test::Noise noise{seed};
    std::vector<PlacedMask> masks = masks_of(s.pieces, s.before);
    for (PlacedMask& m : masks) {
      m.at.x += noise.in(-2, 2);
      m.at.y += noise.in(-2, 2);
    }
    const Extent page{options.width + 2, s.before.used_height + 2};
    const bool done = apart_by(page, masks);
    apart += done;
    EXPECT_EQ(lie_apart(masks, page.width, page.height), done) << seed;
  }
  EXPECT_GE(apart, 10);
}

TEST(Nudge, SaysWhenThereIsNoRoom) {
  const std::vector<Vec2d> box{{0, 0}, {20, 0}, {20, 20}, {0, 0}, {20, 20}, {0, 20}};
  const std::vector<Piece> pieces = pieces_of({outline_of({box, {}})});
  const Mask& mask = pieces[0].masks[0];
  std::vector<PlacedMask> masks{{&mask, {0, 0}}, {&mask, {mask.width, 0}}};
  const Extent page{2 * mask.width - 1, 2 * mask.height - 1};
  EXPECT_FALSE(apart_by(page, masks));
  masks = {{&mask, {0, 0}}, {&mask, {mask.width - 1, 0}}};
  EXPECT_FALSE(apart_by({2 * mask.width, mask.height}, masks, 0));  // no work is left
  masks = {{&mask, {0, 0}}, {&mask, {mask.width, 0}}};
  EXPECT_TRUE(apart_by({2 * mask.width, mask.height}, masks));
  std::vector<PlacedMask> none;
  EXPECT_TRUE(apart_by({1, 1}, none));
}

}  // namespace
}  // namespace atlas
