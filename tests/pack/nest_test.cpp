// Places pieces by plans, and tests the page that only checks places.
#include "libatlas/pack/nesting/nest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "libatlas/pack/nesting/plain_page.h"
#include "tests/pack/one_page.h"
#include "tests/support/layout_checks.h"

namespace atlas {
namespace {

using namespace pack;

std::vector<Piece> blob_pieces(test::Noise& noise, int count, std::uint32_t directions) {
  std::vector<ChartOutline> outlines;
  for (int k = 0; k < count; ++k) {
    const int corners = noise.in(3, 9);
    const double radius = 4.0 + 20 * noise.unit();
    outlines.push_back(outline_of({test::blob(noise, radius, corners), {}}));
  }
  PieceOptions options;
  options.cell = 2;
  options.directions = directions;
  return make_pieces(outlines, options, {});
}

void disturb(test::Noise& noise, std::span<const Piece> pieces, NestPlan& plan) {
  const int n = int(plan.order.size());
  const auto i = std::size_t(noise.in(0, n - 1)), j = std::size_t(noise.in(0, n - 1));
  if (noise.in(0, 2) > 0)
    std::swap(plan.order[i], plan.order[j]);
  else
    plan.direction[i] = noise.in(-1, int(pieces[i].masks.size()) - 1);
}

// If one piece without room is enough to fail, the others are not tried.
TEST(Nest, AllOrNoneEndsWithTheFirstPieceWithoutRoom) {
  test::Noise noise{11};
  const std::vector<Piece> pieces = blob_pieces(noise, 40, 4);
  NestPlan plan = plan_by_size(pieces);
  BitPage page(40, 40, longest_run(pieces)), again(40, 40, longest_run(pieces));
  Nest all, some;
  place_pieces(pieces, plan, page, all);
  ASSERT_GT(all.left_over.size(), 1u);
  plan.all_or_none = true;
  place_pieces(pieces, plan, again, some);
  EXPECT_EQ(some.left_over, std::vector<std::uint32_t>{all.left_over[0]});
  for (const std::uint32_t i : plan.order) {
    if (i == all.left_over[0]) break;
    EXPECT_EQ(some.places[i], all.places[i]);
  }
}

// Searches can be compared half-way: one that was interrupted ends as one that was not.
TEST(NestSearch, InterruptionsChangeNothing) {
  test::Noise noise{7};
  const std::vector<Piece> pieces = blob_pieces(noise, 9, 8);
  NestSearchOptions options;
  options.width = 48;
  options.layouts = 60;
  const NestPlan plan = plan_by_size(pieces);
  const NestSearchResult whole = search_nest(pieces, plan, options, {});
  NestSearch search(pieces, plan, options);
  std::uint64_t before = 0;
  for (const double share : {0.0, 0.25, 0.5, 1.0}) {
    const NestSearchResult& part = search.run(share, {});
    EXPECT_GE(double(part.layouts), std::max(1.0, share * 60));
    EXPECT_GT(part.layouts, before);
    before = part.layouts;
  }
  const NestSearchResult& parts = search.run(1, {});
  EXPECT_EQ(parts.layouts, whole.layouts);
  EXPECT_EQ(parts.work, whole.work);
  EXPECT_EQ(parts.nest.used_height, whole.nest.used_height);
  EXPECT_EQ(parts.nest.places, whole.nest.places);
}

// A single piece has only one order, so there is nothing left to search for.
TEST(NestSearch, APieceAloneIsPutDownOnceInEachDirection) {
  const ChartOutline bar = outline_of({std::vector<Vec2d>{{0, 0}, {30, 0}, {30, 5}}, {}});
  for (const std::uint32_t directions : {1u, 4u, 8u}) {
    PieceOptions options;
    options.directions = directions;
    const std::vector<Piece> pieces = make_pieces(std::vector{bar}, options, {});
    NestSearchOptions search;
    search.width = 40;
    search.layouts = 1000;
    const NestSearchResult found = search_nest(pieces, plan_by_size(pieces), search, {});
    EXPECT_EQ(found.layouts, 1 + directions);
    std::int32_t lowest = 1 << 20;
    for (const Mask& m : pieces[0].masks)
      if (m.width <= search.width) lowest = std::min(lowest, m.height);
    EXPECT_EQ(found.nest.used_height, lowest);
  }
}

// Layouts that are given up as too high leave pieces over, and never count as the lowest.
TEST(NestSearch, NoLayoutThatWasGivenUpIsTakenOfAVeryHighStrip) {
  std::vector<ChartOutline> bars;
  for (const double length : {600'000, 700'000, 900'000})
    bars.push_back(outline_of({test::box(0.5, length), {}}));
  PieceOptions options;
  options.directions = 1;
  const std::vector<Piece> pieces = make_pieces(bars, options, {});
  NestSearchOptions search;
  search.width = 2 * pieces[0].masks[0].width;
  search.layouts = 6;
  const NestSearchResult found = search_nest(pieces, plan_by_size(pieces), search, {});
  EXPECT_GT(found.nest.used_height, 1'000'000);
  EXPECT_TRUE(found.nest.left_over.empty());
}

std::vector<Vec2d> ring(double radius, double width) {
  std::vector<Vec2d> triangles;
  constexpr int kParts = 48;
  const auto at = [](double r, int k) {
    const double angle = 2 * std::numbers::pi * k / kParts;
    return Vec2d{r * std::cos(angle), r * std::sin(angle)};
  };
  for (int k = 0; k < kParts; ++k) {
    const Vec2d a = at(radius - width, k), b = at(radius, k), c = at(radius, k + 1),
                d = at(radius - width, k + 1);
    for (const Vec2d p : {a, b, c, a, c, d}) triangles.push_back(p);
  }
  return triangles;
}

// There are more charts than pressing accepts. Each square covers more area than a ring, but fits
// inside one.
TEST(NestPlans, RingsComeBeforeWhatLiesWithinThem) {
  std::vector<std::vector<Vec2d>> shapes;
  for (int k = 0; k < 12; ++k) shapes.push_back(ring(100, 3));
  for (int k = 0; k < 130; ++k) shapes.push_back(test::box(64, 64));
  const test::ChartItems charts(std::move(shapes));
  const FitOptions options = test::options_for(charts, 2048);
  const Result<FitResult> page = fit_pages(charts.items, options, {});
  ASSERT_TRUE(page.ok());
  EXPECT_GT(page->utilization, 0.55);
  EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, *page), page->pages, options.padding),
            "");
}

// Reusing the places that two plans have in common changes nothing, not even the counted work.
TEST(NestPlans, PlacesTakenOverAreThoseSearchedFor) {
  test::Noise noise{41};
  for (int round = 0; round < 12; ++round) {
    const int width = noise.in(60, round % 3 == 0 ? 600 : 150);
    const std::vector<Piece> pieces = blob_pieces(noise, noise.in(1, 14), round % 2 ? 8 : 4);
    // With a height of 40 some pieces do not fit.
    const std::int32_t height = round == 5 ? 40 : 1 << 20;
    BitPage page(width, height, longest_run(pieces));
    PlacedPlan before, now;
    now.plan = plan_by_size(pieces);
    for (int k = 0; k < 40; ++k) {
      place_pieces_as(pieces, before, page, now);
      BitPage fresh(width, height, longest_run(pieces));
      Nest expected;
      place_pieces(pieces, now.plan, fresh, expected);
      EXPECT_EQ(now.nest.places, expected.places);
      EXPECT_EQ(now.nest.left_over, expected.left_over);
      EXPECT_EQ(now.nest.potential, expected.potential);
      EXPECT_EQ(std::accumulate(now.work.begin(), now.work.end(), std::uint64_t{0}), fresh.work());
      if (expected.left_over.empty()) {
        EXPECT_EQ(now.nest.used_height, expected.used_height);
      }
      if (k == 0 || (expected.left_over.empty() && noise.in(0, 2) == 0)) std::swap(before, now);
      now.plan = before.plan;
      disturb(noise, pieces, now.plan);
      now.plan.most_height = k % 4 == 3 ? before.nest.used_height + noise.in(-9, 9)
                                        : std::numeric_limits<double>::infinity();
    }
  }
}

TEST(PlainPage, KnowsWhatIsFree) {
  test::Noise noise{43};
  const int width = 200, height = 90;
  PlainPage page(width, height);
  BitPage known(width, height, width);
  std::vector<std::pair<Mask, BitPage::Place>> lying;
  for (int k = 0; k < 4000; ++k) {
    const int corners = noise.in(3, 8), radius = noise.in(2, 60);
    const auto shape = test::blob(noise, radius, corners);
    Vec2d origin;
    const Mask mask = rasterize(outline_of({shape, {}}), {}, origin);
    if (mask.width > width || mask.height > height) continue;
    const BitPage::Place at{noise.in(0, width - mask.width), noise.in(0, height - mask.height)};
    bool free = true;
    for (int r = 0; r < mask.height; ++r)
      for (const pack::Run& run : mask.row(r))
        for (int x = run.begin; x < run.end; ++x) free = free && known.is_free(at.x + x, at.y + r);
    ASSERT_EQ(page.is_free(mask, at), free) << k;
    if (free) {
      page.put(mask, at);
      known.put(mask, at);
      lying.emplace_back(mask, at);
    } else if (noise.in(0, 9) == 0 && !lying.empty()) {
      page.take_away(lying.back().first, lying.back().second);
      known.take_away(lying.back().first, lying.back().second);
      lying.pop_back();
    }
  }
  EXPECT_FALSE(lying.empty());
}

}  // namespace
}  // namespace atlas
