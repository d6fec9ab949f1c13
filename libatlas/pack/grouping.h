// Distributes items of given sizes over N groups whose totals are nearly equal: stage 4 of the
// paper.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"

namespace atlas {

struct GroupingOptions {
  std::uint32_t groups = 1;  // N, at least 1
  // The capacity with which the bisection begins, in the unit of the sizes: the area of one page.
  // If first-fit decreasing with this capacity needs at most N groups, these groups are the result,
  // so there may be fewer than N. 0: no such limit; the items are always balanced over N groups.
  std::uint64_t page_capacity = 0;
  // Upper limit on the number of item visits in the refinement. It searches below the bisection's
  // result for smaller capacities that work, which the bisection may miss because F is not
  // monotone. Small cases are searched to the end.
  std::uint64_t refine_work = std::uint64_t{1} << 22;
};

// One evaluation of F: first-fit decreasing with this capacity used this many groups.
struct GroupingStep {
  std::uint64_t capacity = 0;
  std::uint32_t groups = 0;  // N + 1 stands for "more than N", because the count stops there
};

struct GroupingResult {
  std::vector<std::uint32_t> group = {};       // one per item, in input order; < group_count
  std::uint32_t group_count = 0;               // at most N; 0 only if there are no items
  std::vector<std::uint64_t> group_size = {};  // total size of each group
  // A: the smallest capacity that was seen to have F(A) <= N and A >= the largest item.
  std::uint64_t capacity = 0;
  std::uint64_t largest_group = 0;  // at most capacity
  double imbalance = 0;             // largest_group / (total / group_count) - 1; 0 if total is 0
  std::uint64_t lower_bound = 0;    // MULTIFIT: max(ceil(total / N), largest item)
  // MULTIFIT: max(2 ceil(total / N), largest item), where F <= N.
  std::uint64_t upper_bound = 0;
  // No capacity below A has F <= N (the refinement reached the end).
  bool proved_smallest = false;
  bool fits_page = false;                // page_capacity was given and was large enough
  std::vector<GroupingStep> trace = {};  // every (A, F(A)), in the order of evaluation
};

// F(A) of the paper. The items are sorted in descending order (ties by index), and each is put into
// the first group whose total stays <= capacity. Filling one group after another with the largest
// remaining item that fits gives the same groups. The count stops at limit + 1. The result is also
// limit + 1 if an item is larger than the capacity. The limit must be below 2^32 - 1.
std::uint32_t count_groups(std::span<const std::uint64_t> sizes, std::uint64_t capacity,
                           std::uint32_t limit);

// Distributes the items over at most N groups so that the largest group is small. It bisects on the
// capacity A between MULTIFIT's bounds (Coffman, Garey and Johnson 1978), starting from
// page_capacity. It never assumes that F is monotone: the result is the smallest A that was seen to
// satisfy F(A) <= N. Then it tries the capacities below A that give a different packing, in
// descending order, which proves or improves the result on small inputs. It works in exact
// integers.
// Errors: bad_option (groups == 0); bad_input (ceil(total / N) or a single size exceeds 2^62);
// cancelled.
Result<GroupingResult> group_sizes(std::span<const std::uint64_t> sizes,
                                   const GroupingOptions& options, const Context& context);

}  // namespace atlas
