#include "libatlas/pack/engines.h"

namespace atlas::pack {

Layout solve(const Problem& problem, const PackOptions& options, const Context& context,
             PackResult& result) {
  (void)options;
  (void)context;
  result.layouts_tried = 1;
  return pack_first_fit(problem, sorted_items(problem.items, Order::height),
                        PlaceRule::bottom_left);
}

}  // namespace atlas::pack
