#include "libatlas/pack/grouping.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <numeric>

#include "tests/support/layout_checks.h"

namespace atlas {
namespace {

using Sizes = std::vector<std::uint64_t>;

// F(A) as the paper words it: fills one group after another with the largest remaining item that
// fits.
std::uint32_t paper_groups(Sizes sizes, std::uint64_t capacity) {
  std::sort(sizes.rbegin(), sizes.rend());
  if (!sizes.empty() && sizes.front() > capacity) return UINT32_MAX;
  std::uint32_t groups = 0;
  for (; !sizes.empty(); ++groups) {
    std::uint64_t room = capacity;
    Sizes rest;
    for (std::uint64_t s : sizes) {
      if (s <= room)
        room -= s;
      else
        rest.push_back(s);
    }
    sizes = rest;
  }
  return groups;
}

GroupingResult group(const Sizes& sizes, std::uint32_t n, std::uint64_t page = 0) {
  GroupingOptions options;
  options.groups = n;
  options.page_capacity = page;
  Result<GroupingResult> r = group_sizes(sizes, options, {});
  EXPECT_TRUE(r.ok()) << r.status().message();
  return r.ok() ? std::move(*r) : GroupingResult{};
}

void expect_consistent(const Sizes& sizes, const GroupingResult& r, std::uint32_t n) {
  ASSERT_EQ(r.group.size(), sizes.size());
  ASSERT_LE(r.group_count, n);
  Sizes totals(r.group_count);
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    ASSERT_LT(r.group[i], r.group_count);
    totals[r.group[i]] += sizes[i];
  }
  EXPECT_EQ(totals, r.group_size);
  const std::uint64_t all = std::accumulate(totals.begin(), totals.end(), std::uint64_t{0});
  const std::uint64_t largest = *std::max_element(totals.begin(), totals.end());
  EXPECT_LE(largest, r.capacity);
  EXPECT_EQ(r.largest_group, largest);
  const double mean = static_cast<double>(all) / r.group_count;
  EXPECT_NEAR(r.imbalance, static_cast<double>(largest) / mean - 1, 1e-12);
}

TEST(Grouping, CountsAsThePaperDoes) {
  test::Noise noise{5};
  for (int round = 0; round < 300; ++round) {
    Sizes sizes(static_cast<std::size_t>(noise.in(1, 30)));
    for (auto& s : sizes) s = static_cast<std::uint64_t>(noise.in(0, 40));
    const auto capacity = static_cast<std::uint64_t>(noise.in(40, 120));
    EXPECT_EQ(count_groups(sizes, capacity, 1000), paper_groups(sizes, capacity));
  }
}

TEST(Grouping, SmallestCapacityOfAllOnSmallCases) {
  test::Noise noise{7};
  int harder = 0;
  for (int round = 0; round < 500; ++round) {
    Sizes sizes(static_cast<std::size_t>(noise.in(1, 12)));
    for (auto& s : sizes) s = static_cast<std::uint64_t>(noise.in(1, 50));
    const auto n = static_cast<std::uint32_t>(noise.in(1, 5));
    std::uint64_t best = *std::max_element(sizes.begin(), sizes.end());
    while (paper_groups(sizes, best) > n) ++best;
    const GroupingResult r = group(sizes, n);
    expect_consistent(sizes, r, n);
    EXPECT_EQ(r.capacity, best);
    EXPECT_TRUE(r.proved_smallest);
    harder += r.capacity > r.lower_bound;
  }
  EXPECT_GT(harder, 100);  // in these cases the lower bound alone did not decide
}

TEST(Grouping, ALimitOfAnyHeightTakesNoMemory) {
  EXPECT_EQ(count_groups(Sizes{5, 4, 3}, 5, UINT32_MAX - 1), 3u);
  EXPECT_EQ(count_groups(Sizes{6, 4, 3}, 5, UINT32_MAX - 1), UINT32_MAX);
  EXPECT_EQ(count_groups({}, 5, UINT32_MAX - 1), 0u);
}

// Bounds of 11/9 and 13/11 of the optimum are proved for first-fit decreasing and MULTIFIT. The
// optimum is found here by trying all assignments.
TEST(Grouping, WithinMultifitsBoundOfTheOptimum) {
  test::Noise noise{11};
  for (int round = 0; round < 60; ++round) {
    Sizes sizes(static_cast<std::size_t>(noise.in(3, 8)));
    for (auto& s : sizes) s = static_cast<std::uint64_t>(noise.in(1, 60));
    constexpr std::uint32_t n = 3;
    std::uint64_t optimum = UINT64_MAX;
    std::size_t codes = 1;
    for (std::size_t k = 0; k < sizes.size(); ++k) codes *= n;
    for (std::size_t code = 0; code < codes; ++code) {
      std::uint64_t load[n] = {};
      std::size_t c = code;
      for (std::uint64_t s : sizes) {
        load[c % n] += s;
        c /= n;
      }
      optimum = std::min(optimum, *std::max_element(load, load + n));
    }
    const GroupingResult r = group(sizes, n);
    EXPECT_LE(r.largest_group * 11, optimum * 13);
    EXPECT_GE(r.largest_group, optimum);
    EXPECT_LE(r.lower_bound, optimum);
  }
}

// Coffman, Garey and Johnson: a larger capacity can need more groups.
TEST(Grouping, AnomalyOfFirstFitDecreasing) {
  const Sizes sizes{44, 24, 24, 22, 21, 17, 8, 8, 6, 6};
  ASSERT_EQ(count_groups(sizes, 60, 9), 3u);
  ASSERT_EQ(count_groups(sizes, 61, 9), 4u);
  const GroupingResult r = group(sizes, 3);
  EXPECT_EQ(r.capacity, 60u);
  EXPECT_EQ(r.group_count, 3u);
  // A bisection that starts from 61, where F is 4, must still find 60.
  const GroupingResult from_page = group(sizes, 3, 61);
  EXPECT_LE(from_page.group_count, 3u);
  EXPECT_EQ(from_page.capacity, 60u);
}

TEST(Grouping, TenEqualSizesMakeNoSixGroups) {
  const GroupingResult r = group(Sizes(10, 7), 6);
  EXPECT_EQ(r.group_count, 5u);
  EXPECT_EQ(r.capacity, 14u);
}

TEST(Grouping, EdgeCases) {
  EXPECT_EQ(group({}, 4).group_count, 0u);
  EXPECT_EQ(group({5, 3, 9}, 1).capacity, 17u);
  EXPECT_EQ(group({5, 3, 9}, 50).group_count, 2u);
  EXPECT_EQ(group({5, 3, 9}, 50).capacity, 9u);
  EXPECT_EQ(group({0, 0, 0}, 2).capacity, 0u);
  const GroupingResult giant = group({1000, 1, 1, 1, 1}, 2);
  EXPECT_EQ(giant.capacity, 1000u);
  EXPECT_EQ(giant.group_count, 2u);
  GroupingOptions none;
  none.groups = 0;
  EXPECT_EQ(group_sizes({}, none, {}).status().code(), ErrorCode::bad_option);
}

TEST(Grouping, EnormousSizes) {
  constexpr std::uint64_t huge = std::uint64_t{1} << 62;
  EXPECT_EQ(group({huge, huge, huge}, 3).capacity, huge);
  EXPECT_EQ(group({huge / 2, huge / 2, 1}, 2).capacity, huge / 2 + 1);
  GroupingOptions two;
  two.groups = 2;
  const Sizes too_much(5, huge);
  EXPECT_EQ(group_sizes(too_much, two, {}).status().code(), ErrorCode::bad_input);
}

// Each run of the refinement visits every item once, and its limit counts these visits.
TEST(Grouping, RefinementKeepsToItsWork) {
  test::Noise noise{19};
  Sizes sizes(60);
  for (auto& s : sizes) s = static_cast<std::uint64_t>(noise.in(1, 1'000'000));
  GroupingOptions options;
  options.groups = 17;
  std::vector<std::size_t> steps;
  for (const std::uint64_t work : {0u, 59u, 60u, 60u * 3 + 59u}) {
    options.refine_work = work;
    const Result<GroupingResult> r = group_sizes(sizes, options, {});
    ASSERT_TRUE(r.ok());
    expect_consistent(sizes, *r, 17);
    EXPECT_FALSE(r->proved_smallest);
    steps.push_back(r->trace.size());
  }
  EXPECT_EQ(steps[1], steps[0]);
  EXPECT_EQ(steps[2], steps[0] + 1);
  EXPECT_EQ(steps[3], steps[0] + 3);
}

TEST(Grouping, StopsWhenCancelled) {
  const std::atomic<bool> stop{true};
  Context context;
  context.cancel = &stop;
  GroupingOptions options;
  options.groups = 3;
  const Sizes sizes{44, 24, 24, 22, 21, 17, 8, 8, 6, 6};
  EXPECT_EQ(group_sizes(sizes, options, context).status().code(), ErrorCode::cancelled);
}

TEST(Grouping, PageThatHoldsAllNeedsFewerGroups) {
  const GroupingResult r = group({10, 10, 10, 10}, 4, 20);
  EXPECT_TRUE(r.fits_page);
  EXPECT_EQ(r.group_count, 2u);
  EXPECT_EQ(r.capacity, 20u);
  ASSERT_EQ(r.trace.size(), 1u);
  EXPECT_EQ(r.trace[0].capacity, 20u);
}

TEST(Grouping, ManyLogNormalSizesAreNearlyEven) {
  Sizes sizes;
  for (const Extent& e : test::log_normal_rects(10000, 3))
    sizes.push_back(static_cast<std::uint64_t>(e.area()));
  const GroupingResult r = group(sizes, 50);
  expect_consistent(sizes, r, 50);
  const double mean =
      static_cast<double>(std::accumulate(sizes.begin(), sizes.end(), std::uint64_t{0})) / 50;
  EXPECT_LT(static_cast<double>(r.largest_group), 1.001 * mean);
  for (const GroupingStep& s : r.trace)
    EXPECT_EQ(s.groups, count_groups(sizes, s.capacity, 50)) << s.capacity;
}

}  // namespace
}  // namespace atlas
