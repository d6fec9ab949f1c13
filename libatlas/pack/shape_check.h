// Internal: checks of shapes and the choice of a grid, shared by pack_outlines and fit_pages.
#pragma once

#include <functional>
#include <span>

#include "libatlas/pack/outline.h"

namespace atlas::pack {

Status check_shapes(std::span<const ChartShape> shapes);
Status check_rotations(std::uint32_t rotations);

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

// Runs one task per chain, on up to context.threads threads.
void parallel_chains(const Context& context, std::size_t chains,
                     const std::function<void(std::size_t)>& run);

}  // namespace atlas::pack
