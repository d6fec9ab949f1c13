// Internal: what pack_outlines and fit_pages share about shapes and grids.
#pragma once

#include <functional>
#include <span>

#include "libatlas/pack/outline.h"

namespace atlas::pack {

Status check_shapes(std::span<const ChartShape> shapes);
Status check_rotations(std::uint32_t rotations);

// What a grid is chosen for.
struct GridWish {
  std::size_t charts = 0;
  std::int32_t page_side = 0, alignment = 1;  // texels
  std::uint32_t rotations = 4;                // directions at most
  double affordable = 0;                      // looks at words that one layout may cost, about
  // How wide the charts are on a full page, in texels: about twice the width of needles; 0: only
  // their number counts.
  double mean_side = 0;
};

// Cell size (a power of two times the alignment) and number of directions.
struct GridChoice {
  std::int32_t cell = 1;
  std::uint32_t directions = 4;
};
double layout_cost(std::size_t count, double side_cells, std::uint32_t directions);
GridChoice choose_grid(const GridWish& wish);

// One task a chain, on up to context.threads threads.
void parallel_chains(const Context& context, std::size_t chains,
                     const std::function<void(std::size_t)>& run);

}  // namespace atlas::pack
