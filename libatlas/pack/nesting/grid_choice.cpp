#include "libatlas/pack/nesting/grid_choice.h"

#include <algorithm>
#include <cmath>

namespace atlas::pack {

// A piece costs about 0.0055 examined words per direction and squared page side in cells.
double layout_cost(std::size_t count, double side_cells, std::uint32_t directions) {
  return static_cast<double>(count) * directions * side_cells * side_cells * 0.0055;
}

GridChoice choose_grid(const GridWish& wish) {
  GridChoice best{wish.alignment, std::min(wish.rotations, 4u)};
  const double n = static_cast<double>(std::max<std::size_t>(wish.charts, 1));
  // Coarse cells cost half a cell around each chart. If a mean chart is 32 cells wide, this is a
  // few percent, and finer grids gain less than more layouts do.
  const auto cells_a_chart = [&](std::int32_t cell) {
    return wish.page_side / double(cell) * std::sqrt(0.75 / n);
  };
  while (wish.page_side / (2 * best.cell) >= 512 && cells_a_chart(2 * best.cell) >= 32)
    best.cell *= 2;
  const auto is_affordable = [&](std::uint32_t directions) {
    return layout_cost(wish.charts, wish.page_side / double(best.cell), directions) <=
           wish.affordable;
  };
  // Needles do not fit coarse cells well either: these reduced the fill of a page with a thousand
  // long charts from 0.59 to 0.56. So a layout of needles may cost more.
  constexpr double kForNeedles = 8;
  const auto too_coarse = [&](std::int32_t cell) {
    const double cost =
        layout_cost(wish.charts, wish.page_side / double(cell / 2), best.directions);
    const bool narrow = wish.mean_side > 0 && wish.mean_side < 8 * cell;
    return cells_a_chart(cell) < 8 || (narrow && cost <= kForNeedles * wish.affordable);
  };
  while (!is_affordable(best.directions) && !too_coarse(2 * best.cell)) best.cell *= 2;
  while (best.directions * 2 <= wish.rotations && is_affordable(best.directions * 2))
    best.directions *= 2;
  while (best.directions > 4 && wish.rotations % best.directions != 0) best.directions -= 4;
  return best;
}

}  // namespace atlas::pack
