// Internal: sorting by an order of one's own. Standard libraries leave elements of which neither is
// less in different orders, so the order must tell all elements apart that differ.
#pragma once

#include <algorithm>
#include <cassert>
#include <concepts>
#include <iterator>

namespace atlas {

// Sorts like std::sort(). Elements of which neither is less must be equal (checked in builds with
// assertions, if they can be compared).
template <std::random_access_iterator Iterator, class Less>
void sort_total(Iterator first, Iterator last, const Less& less) {
  std::sort(first, last, less);
  if constexpr (std::equality_comparable<std::iter_value_t<Iterator>>) {
    assert(std::adjacent_find(first, last, [&](const auto& a, const auto& b) {
             return !less(a, b) && !(a == b);
           }) == last);
  }
}

// Like std::nth_element(), with the same rule. The order on either side is left open.
template <std::random_access_iterator Iterator, class Less>
void nth_total(Iterator first, Iterator nth, Iterator last, const Less& less) {
  std::nth_element(first, nth, last, less);
}

}  // namespace atlas
