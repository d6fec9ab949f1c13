// Grouping and packing at the limits of their ranges. All references are exact integers.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "benchmarks/stability/checks.h"
#include "libatlas/pack/grouping.h"
#include "libatlas/pack/pack.h"

namespace atlas::bench {
namespace {

constexpr double kNever = std::numeric_limits<double>::quiet_NaN();
using Sizes = std::vector<std::uint64_t>;

// Counts items in no group, groups with a wrong total or above the capacity, and too many groups.
double wrong(const Sizes& sizes, const GroupingResult& r, std::uint32_t limit) {
  std::uint64_t bad = r.group_count > limit;
  Sizes totals(r.group_count);
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (r.group[i] >= r.group_count)
      ++bad;
    else
      totals[r.group[i]] += sizes[i];
  }
  for (std::uint32_t g = 0; g < r.group_count; ++g)
    bad += totals[g] != r.group_size[g] || totals[g] > r.capacity;
  return double(bad);
}

void group(CheckList& list, const std::string& stress, const Sizes& sizes, std::uint32_t groups) {
  GroupingOptions options;
  options.groups = groups;
  options.refine_work = 0;  // the bisection alone, whose number of steps has a bound
  const Result<GroupingResult> r = group_sizes(sizes, options, list.context);
  const StressChecks at = list.at("grouping", stress);
  at.add("wrong groups", r.ok() ? wrong(sizes, *r, groups) : kNever, 0);
  at.add("evaluations of F", r.ok() ? double(r->trace.size()) : kNever, 66,
         "bisection of a 64-bit range and its two ends");
}

void pack(const StressChecks& at, const std::vector<Extent>& items, const PackOptions& options,
          std::uint32_t pages) {
  const Result<PackResult> r = pack_rects(items, options, at.context());
  at.add("items without a place", r.ok() ? double(r->unplaced.size()) : kNever, 0);
  at.add("pages", r.ok() ? double(r->pages.size()) : kNever, pages,
         fmt::format("{} needed", pages));
  double outside = r.ok() ? 0 : kNever;
  if (r.ok()) {
    for (std::size_t i = 0; i < items.size(); ++i) {
      const Placement& p = r->placements[i];
      if (!p.placed()) continue;
      const Extent e = p.rotated ? Extent{items[i].height, items[i].width} : items[i];
      outside += p.x < 0 || p.y < 0 || std::int64_t(p.x) + e.width > options.page.width ||
                 std::int64_t(p.y) + e.height > options.page.height;
    }
  }
  at.add("items outside their page", outside, 0);
}

}  // namespace

void check_grouping(CheckList& list) {
  const std::uint32_t many = list.options.full ? 100000 : 2000;
  group(list, "ten equal sizes, N = 6", Sizes(10, 7), 6);
  for (const std::uint32_t n : {1u, 2u, many / 2, many})
    group(list, fmt::format("{} ties, N = {}", many, n), Sizes(many, 1u << 20), n);
  Sizes spread;
  for (int e = 0; e < 62; ++e) spread.push_back(std::uint64_t(1) << e);
  for (const std::uint32_t n : {1u, 2u, 31u, 62u, 100u})
    group(list, fmt::format("1 to 2^61, N = {}", n), spread, n);
  group(list, "zeros", Sizes(50, 0), 7);
  group(
      list, "one giant among ones",
      [&] {
        Sizes s(many, 1);
        s[many / 2] = std::uint64_t(1) << 61;
        return s;
      }(),
      8);
  // Coffman, Garey and Johnson 1978: a larger capacity can need more groups.
  const Sizes anomaly{44, 24, 24, 22, 21, 17, 8, 8, 6, 6};
  const int at_60 = int(count_groups(anomaly, 60, 10)), at_61 = int(count_groups(anomaly, 61, 10));
  list.at("grouping", "the anomaly of MULTIFIT's paper")
      .add("F(60) and F(61) differ from 3 and 4", std::abs(at_60 - 3) + std::abs(at_61 - 4), 0,
           "F is not monotone");
  GroupingOptions options;
  options.groups = 3;
  const Result<GroupingResult> best = group_sizes(anomaly, options, list.context);
  list.at("grouping", "the same, N = 3, refined")
      .add("capacity", best.ok() ? double(best->capacity) : kNever, 60,
           "60 is the optimum: the total is 180");
}

void check_packing(CheckList& list) {
  PackOptions one;
  one.page = {2048, 2048};
  pack(list.at("packing", "page = item"), {{2048, 2048}}, one, 1);
  pack(list.at("packing", "five items of the page's size"), std::vector<Extent>(5, {2048, 2048}),
       one, 5);
  const int side = list.options.full ? 1000 : 100;
  PackOptions small;
  small.page = {side, side};
  pack(list.at("packing", fmt::format("{} items of 1 x 1, none to spare", side * side)),
       std::vector<Extent>(std::size_t(side) * std::size_t(side), {1, 1}), small, 1);
  PackOptions wide;
  wide.page = {1 << 30, 4};
  pack(list.at("packing", "four items 10^9 wide"), std::vector<Extent>(4, {1000000000, 1}), wide,
       1);
  PackOptions high;
  high.page = {4, 1 << 30};
  pack(list.at("packing", "four items 10^9 high"), std::vector<Extent>(4, {1, 1000000000}), high,
       1);
  PackOptions flat;
  flat.page = {64, 64};
  pack(list.at("packing", "sides of 0"), std::vector<Extent>(10, {0, 5}), flat, 1);
}

}  // namespace atlas::bench
