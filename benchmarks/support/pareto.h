// Finds the Pareto front of several settings.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

namespace atlas::bench {

// Returns the items that no other beats in both coordinates, by ascending x. x and y return the
// coordinates of an item.
template <class Item, class X, class Y>
std::vector<Item> pareto_front(std::vector<Item> items, X x, Y y) {
  std::stable_sort(items.begin(), items.end(), [&](const Item& a, const Item& b) {
    return x(a) != x(b) ? x(a) < x(b) : y(a) < y(b);
  });
  double best = std::numeric_limits<double>::infinity();
  std::erase_if(items, [&](const Item& item) {
    if (y(item) >= best) return true;
    best = y(item);
    return false;
  });
  return items;
}

}  // namespace atlas::bench
