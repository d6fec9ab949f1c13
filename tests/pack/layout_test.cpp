#include "libatlas/pack/layout.h"

#include <gtest/gtest.h>

#include "tests/pack/layout_fuzz.h"
#include "tests/support/layout_checks.h"

namespace atlas {
namespace {

TEST(AtlasLayout, InsertsRemovesRepacks) {
  PackOptions o;
  o.page = {10, 10};
  Result<AtlasLayout> layout = AtlasLayout::create(o);
  ASSERT_TRUE(layout.ok());
  EXPECT_EQ(*layout->insert({10, 6}), 0u);
  EXPECT_EQ(*layout->insert({10, 4}), 1u);
  EXPECT_EQ(*layout->insert({10, 5}), 2u);
  EXPECT_EQ(layout->placement(2).page, 1u);
  EXPECT_TRUE(layout->remove(0));
  EXPECT_FALSE(layout->remove(0));
  EXPECT_FALSE(layout->contains(0));
  // The freed rows are used again.
  EXPECT_EQ(*layout->insert({7, 6}), 3u);
  EXPECT_EQ(layout->placement(3).page, 0u);
  ASSERT_TRUE(layout->repack({}).ok());
  EXPECT_EQ(layout->size(), 3u);
  EXPECT_EQ(layout->page_count(), 2u);
}

TEST(AtlasLayout, SaysWhyAnItemDoesNotFit) {
  PackOptions o;
  o.page = {10, 10};
  o.max_pages = 1;
  Result<AtlasLayout> layout = AtlasLayout::create(o);
  ASSERT_TRUE(layout.ok());
  EXPECT_EQ(layout->insert({11, 1}).status().code(), ErrorCode::no_solution);
  EXPECT_EQ(layout->insert({-1, 1}).status().code(), ErrorCode::bad_input);
  EXPECT_TRUE(layout->insert({10, 10}).ok());
  EXPECT_EQ(layout->insert({1, 1}).status().code(), ErrorCode::no_solution);
  EXPECT_TRUE(layout->insert({0, 1}).ok());
  o.page.height = 0;
  EXPECT_EQ(AtlasLayout::create(o).status().code(), ErrorCode::bad_option);
}

// The page count is that of the highest page in use, also if pages before it are empty.
TEST(AtlasLayout, TellsPagesAndTheirFill) {
  PackOptions o;
  o.page = {10, 10};
  Result<AtlasLayout> layout = AtlasLayout::create(o);
  ASSERT_TRUE(layout.ok());
  EXPECT_EQ(layout->page_count(), 0u);
  EXPECT_EQ(layout->utilization(), 0);
  for (int k = 0; k < 3; ++k) ASSERT_TRUE(layout->insert({10, 6 + k}).ok());
  EXPECT_EQ(layout->page_count(), 3u);
  EXPECT_NEAR(layout->utilization(), 210.0 / 300, 1e-12);
  EXPECT_TRUE(layout->remove(0));
  EXPECT_EQ(layout->page_count(), 3u);
  EXPECT_NEAR(layout->utilization(), 150.0 / 300, 1e-12);
  ASSERT_TRUE(layout->repack({}).ok());
  EXPECT_EQ(layout->page_count(), 2u);
  EXPECT_NEAR(layout->utilization(), 150.0 / 200, 1e-12);
  EXPECT_EQ(layout->extent(2), (Extent{10, 8}));
}

TEST(AtlasLayout, PinnedRectanglesWithoutAreaTakeNoSpace) {
  const std::vector<PinnedRect> pins{{0, {5, 2, 0, 4}}, {0, {2, 5, 4, 0}}};
  PackOptions o;
  o.page = {10, 10};
  o.max_pages = 1;
  o.pinned = pins;
  Result<AtlasLayout> layout = AtlasLayout::create(o);
  ASSERT_TRUE(layout.ok());
  EXPECT_TRUE(layout->insert({10, 10}).ok());
  EXPECT_TRUE(layout->repack({}).ok());
}

TEST(AtlasLayout, RandomOperationsKeepTheRules) {
  for (std::uint64_t seed = 0; seed < 20000; ++seed)
    ASSERT_EQ(test::fuzz_layout(seed), "") << "seed " << seed;
}

TEST(PackFuzz, RectangleSets) {
  for (std::uint64_t seed = 0; seed < 1000; ++seed)
    ASSERT_EQ(test::fuzz_rects(seed), "") << "seed " << seed;
}

TEST(PackFuzz, OutlineSets) {
  for (std::uint64_t seed = 0; seed < 8; ++seed)
    ASSERT_EQ(test::fuzz_outlines(seed), "") << "seed " << seed;
}

}  // namespace
}  // namespace atlas
