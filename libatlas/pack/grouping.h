// Sharing items of given sizes out over N groups of nearly equal total: the paper's stage 4.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"

namespace atlas {

struct GroupingOptions {
  std::uint32_t groups = 1;  // N, at least 1
  // Where the bisection begins, in the unit of the sizes: the area of one page. If first-fit
  // decreasing with this capacity needs at most N groups they are returned as they are (so fewer
  // than N are possible). 0: no such limit, always balance over N groups.
  std::uint64_t page_capacity = 0;
  // Upper limit on item visits spent in searching below the bisection's answer for smaller
  // capacities that the non-monotone F hides; small cases are searched to the end.
  std::uint64_t refine_work = std::uint64_t{1} << 22;
};

// One evaluation of F: first-fit decreasing with this capacity used this many groups.
struct GroupingStep {
  std::uint64_t capacity = 0;
  std::uint32_t groups = 0;  // N + 1 stands for "more than N": the count stops there
};

struct GroupingResult {
  std::vector<std::uint32_t> group;       // 1 an item, in input order, < group_count
  std::uint32_t group_count = 0;          // at most N; 0 only without items
  std::vector<std::uint64_t> group_size;  // total size a group
  std::uint64_t capacity = 0;       // A: the smallest seen with F(A) <= N and A >= largest item
  std::uint64_t largest_group = 0;  // at most capacity
  double imbalance = 0;             // largest_group / (total / group_count) - 1; 0 if total is 0
  std::uint64_t lower_bound = 0;    // MULTIFIT: max(ceil(total / N), largest item)
  std::uint64_t upper_bound = 0;    // MULTIFIT: max(2 ceil(total / N), largest item); F <= N there
  bool proved_smallest = false;  // no capacity below A has F <= N (the refinement reached the end)
  bool fits_page = false;        // page_capacity was given and was enough
  std::vector<GroupingStep> trace;  // every (A, F(A)) in the order of evaluation
};

// F(A) of the paper: items sorted descending (ties by index), each put into the first group whose
// total stays <= capacity; the same groups result from filling one group after another with the
// largest item left that fits. Stops counting at limit + 1. Returns limit + 1 too if an item is
// larger than the capacity. The limit is below 2^32 - 1.
std::uint32_t count_groups(std::span<const std::uint64_t> sizes, std::uint64_t capacity,
                           std::uint32_t limit);

// Shares the items out over at most N groups such that the largest group is small. Bisects on the
// capacity A between MULTIFIT's bounds (Coffman, Garey and Johnson 1978), starting from
// page_capacity, never assuming that F is monotone: the answer is the smallest A that was seen to
// satisfy F(A) <= N. Then walks down through the capacities below it whose packing differs, which
// proves or improves the answer on small inputs. Works in exact integers.
// Errors: bad_option (groups == 0); bad_input (2 ceil(total / N) passes 2^63); cancelled.
Result<GroupingResult> group_sizes(std::span<const std::uint64_t> sizes,
                                   const GroupingOptions& options, const Context& context);

}  // namespace atlas
