#include "libatlas/pack/rectangles/turned_problem.h"

namespace atlas::pack {

TurnedProblem::TurnedProblem(const Problem& problem, Turn turn)
    : problem_(problem),
      original_(problem.items),
      items_(problem.items.begin(), problem.items.end()) {
  const auto fits = [&](Extent e) {
    return e.width <= problem.page.width && e.height <= problem.page.height;
  };
  for (Extent& e : items_) {
    const Extent turned{e.height, e.width};
    const bool wished = turn == Turn::standing ? e.width > e.height
                        : turn == Turn::lying  ? e.height > e.width
                                               : false;
    if (!fits(e) || (wished && fits(turned))) e = turned;
  }
  problem_.items = items_;
  problem_.allow_rotation = false;
}

void TurnedProblem::turn_back(Layout& layout) const {
  for (std::size_t i = 0; i < items_.size(); ++i) layout.placements[i].rotated = turned(i);
}

}  // namespace atlas::pack
