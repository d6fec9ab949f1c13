#include "libatlas/pack/grouping.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <numeric>

namespace atlas {
namespace {

// First fit over at most `limit` bins in O(log limit) per item. It uses a tournament tree over the
// remaining room, whose inner nodes hold the largest room of their leaves. Bins that are not open
// yet have their full room, so the leftmost leaf with enough room is the first fit.
class FirstFit {
 public:
  FirstFit(std::uint64_t capacity, std::uint32_t limit)
      : leaves_(std::bit_ceil(std::max(limit, 1u))),
        limit_(limit),
        room_(2 * std::size_t{leaves_}) {
    reset(capacity);
  }

  void reset(std::uint64_t capacity) {
    capacity_ = capacity;
    used_ = 0;
    largest_load_ = 0;
    std::fill(room_.begin(), room_.end(), capacity);
  }

  // Returns the bin into which the item was put; limit if no bin has room.
  std::uint32_t place(std::uint64_t size) {
    if (room_[1] < size) return limit_;
    std::size_t node = 1;
    while (node < leaves_) node = 2 * node + (room_[2 * node] < size);
    const auto bin = static_cast<std::uint32_t>(node - leaves_);
    if (bin >= limit_) return limit_;  // only leaves beyond the limit have room
    room_[node] -= size;
    largest_load_ = std::max(largest_load_, capacity_ - room_[node]);
    used_ = std::max(used_, bin + 1);
    for (node /= 2; node >= 1; node /= 2)
      room_[node] = std::max(room_[2 * node], room_[2 * node + 1]);
    return bin;
  }

  std::uint32_t used() const { return used_; }
  std::uint64_t largest_load() const { return largest_load_; }

 private:
  std::size_t leaves_;
  std::uint32_t limit_, used_ = 0;
  std::uint64_t capacity_ = 0, largest_load_ = 0;
  std::vector<std::uint64_t> room_;
};

std::vector<std::uint32_t> descending_order(std::span<const std::uint64_t> sizes) {
  std::vector<std::uint32_t> order(sizes.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return sizes[a] > sizes[b]; });
  return order;
}

// The search for the smallest capacity. There must be sizes, sorted in descending order.
class Search {
 public:
  Search(std::vector<std::uint64_t> sorted, std::uint32_t groups, GroupingResult& result)
      : sorted_(std::move(sorted)), groups_(groups), fit_(0, groups), result_(result) {}

  // Returns F(capacity), counted up to groups + 1, and adds it to the trace.
  std::uint32_t evaluate(std::uint64_t capacity) {
    fit_.reset(capacity);
    const bool all = std::all_of(sorted_.begin(), sorted_.end(),
                                 [&](std::uint64_t size) { return fit_.place(size) < groups_; });
    result_.trace.push_back({capacity, all ? fit_.used() : groups_ + 1});
    return result_.trace.back().groups;
  }

  // Bisection. `low` is a capacity known to be too small (or one below the lower bound), `high` one
  // that is enough. Every capacity that becomes `high` was evaluated with F <= N, so the result is
  // valid whether or not F is monotone. The interval halves in every step, so there are at most 64
  // steps. If F is not monotone, a smaller capacity that works may be missed below `low`.
  std::uint64_t bisect(std::uint64_t low, std::uint64_t high, const Context& context) {
    while (high - low > 1 && !context.cancelled()) {
      const std::uint64_t middle = low + (high - low) / 2;
      // A run that fits also proves a smaller capacity. If the capacity is reduced to the run's
      // largest load, every decision stays the same: an item that did not fit still does not, and
      // an item that fitted still fits. Hence F(largest load) <= N as well.
      if (evaluate(middle) <= groups_)
        high = std::max(low + 1, fit_.largest_load());
      else
        low = middle;
    }
    return high;
  }

  // Tries the capacities below `best` that lead to different runs, in descending order. A run with
  // capacity C and largest load L makes the same decisions for every capacity in [L, C], so the
  // next capacity worth a try is L - 1. If the search reaches the lower bound, `best` is proved to
  // be the smallest. A run that fails (more than N groups) is continued over unlimited bins to find
  // its true largest load.
  std::uint64_t refine(std::uint64_t best, std::uint64_t lower, std::uint64_t work,
                       const Context& context) {
    const std::uint64_t cost = sorted_.size();
    FirstFit open(0, static_cast<std::uint32_t>(sorted_.size()));
    std::uint64_t capacity = best;
    while (capacity > lower) {
      if (work < cost || context.cancelled()) return best;
      work -= cost;
      open.reset(--capacity);
      for (std::uint64_t size : sorted_) open.place(size);
      if (open.used() <= groups_) best = open.largest_load();
      result_.trace.push_back({capacity, std::min(open.used(), groups_ + 1)});
      capacity = open.largest_load();
    }
    result_.proved_smallest = true;
    return best;
  }

 private:
  std::vector<std::uint64_t> sorted_;
  std::uint32_t groups_;
  FirstFit fit_;
  GroupingResult& result_;
};

// Computes ceil(total / groups) in 64 bits. Returns false if it, or a size, exceeds 2^62.
bool mean_size(std::span<const std::uint64_t> sizes, std::uint32_t groups, std::uint64_t& mean) {
  constexpr std::uint64_t limit = std::uint64_t{1} << 62;
  std::uint64_t quotient = 0, rest = 0;
  for (std::uint64_t size : sizes) {
    rest += size % groups;  // < 2 groups, below 2^33
    quotient += size / groups + rest / groups;
    rest %= groups;
    if (quotient > limit || size > limit) return false;
  }
  mean = quotient + (rest > 0);
  return true;
}

void assign(std::span<const std::uint64_t> sizes, std::span<const std::uint32_t> order,
            std::uint32_t groups, GroupingResult& result) {
  FirstFit fit(result.capacity, groups);
  result.group.resize(sizes.size());
  for (std::uint32_t item : order) result.group[item] = fit.place(sizes[item]);
  result.group_count = fit.used();
  result.group_size.assign(result.group_count, 0);
  for (std::size_t i = 0; i < sizes.size(); ++i) result.group_size[result.group[i]] += sizes[i];
  double total = 0;
  for (std::uint64_t size : result.group_size) {
    result.largest_group = std::max(result.largest_group, size);
    total += static_cast<double>(size);
  }
  if (total > 0)
    result.imbalance = static_cast<double>(result.largest_group) * result.group_count / total - 1;
}

}  // namespace

std::uint32_t count_groups(std::span<const std::uint64_t> sizes, std::uint64_t capacity,
                           std::uint32_t limit) {
  // No more groups than items are ever opened, however high the limit is.
  const auto most = static_cast<std::uint32_t>(std::min<std::size_t>(limit, sizes.size()));
  FirstFit fit(capacity, most);
  for (std::uint32_t item : descending_order(sizes))
    if (fit.place(sizes[item]) == most) return limit + 1;
  return fit.used();
}

Result<GroupingResult> group_sizes(std::span<const std::uint64_t> sizes,
                                   const GroupingOptions& options, const Context& context) {
  if (options.groups == 0)
    return Status(ErrorCode::bad_option, "grouping: groups is 0 (ask for at least one)");
  GroupingResult result;
  if (sizes.empty()) return result;
  // More groups than items are never used: with the largest item as capacity, each item fits a
  // group of its own.
  const auto groups =
      static_cast<std::uint32_t>(std::min<std::size_t>(options.groups, sizes.size()));
  std::uint64_t mean = 0;
  if (!mean_size(sizes, groups, mean))
    return Status(ErrorCode::bad_input,
                  fmt::format("grouping: sizes of {} items in {} groups pass 2^62 a group (use a "
                              "coarser unit)",
                              sizes.size(), groups));
  const std::vector<std::uint32_t> order = descending_order(sizes);
  std::vector<std::uint64_t> sorted(sizes.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) sorted[i] = sizes[order[i]];
  const std::uint64_t largest = sorted.front();
  result.lower_bound = std::max(mean, largest);
  result.upper_bound = std::max(2 * mean, largest);

  Search search(std::move(sorted), groups, result);
  std::uint64_t low = result.lower_bound - (result.lower_bound > 0);
  std::uint64_t high = result.upper_bound;
  if (options.page_capacity > 0) {
    if (search.evaluate(options.page_capacity) <= groups) {
      result.fits_page = true;
      result.capacity = options.page_capacity;
    } else if (options.page_capacity > low && options.page_capacity < high) {
      low = options.page_capacity;
    }
  }
  if (!result.fits_page) {
    if (search.evaluate(result.lower_bound) <= groups) {
      high = result.lower_bound;
      result.proved_smallest = true;
    } else {
      low = std::max(low, result.lower_bound);
      search.evaluate(high);  // MULTIFIT's theorem: F <= N at the upper bound
      high = search.bisect(low, high, context);
      high = search.refine(high, result.lower_bound, options.refine_work, context);
    }
    result.capacity = high;
  }
  if (context.cancelled()) return Status::cancelled();
  assign(sizes, order, groups, result);
  return result;
}

}  // namespace atlas
