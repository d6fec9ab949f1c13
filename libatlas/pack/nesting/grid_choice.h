// Internal: the choice of the cells and the directions in which outlines are laid out.
#pragma once

#include <cstddef>
#include <cstdint>

namespace atlas::pack {

// The conditions for which a grid is chosen.
struct GridWish {
  std::size_t charts = 0;
  std::int32_t page_side = 0, alignment = 1;  // in texels
  std::uint32_t rotations = 4;                // maximum number of directions
  double affordable = 0;  // number of words that one layout may examine, approximately
  // The mean width of the charts on a full page in texels. For needles it is about twice their
  // width. 0: only the number of charts counts.
  double mean_side = 0;
};

// The cell size in texels (a power of two times the alignment) and the number of directions.
struct GridChoice {
  std::int32_t cell = 1;
  std::uint32_t directions = 4;
};
double layout_cost(std::size_t count, double side_cells, std::uint32_t directions);
GridChoice choose_grid(const GridWish& wish);

}  // namespace atlas::pack
