// Internal: what pack_outlines and fit_pages share about shapes and grids.
#pragma once

#include <functional>
#include <span>

#include "libatlas/pack/outline.h"

namespace atlas::pack {

Status check_shapes(std::span<const ChartShape> shapes);
Status check_rotations(std::uint32_t rotations);

// Cell size (a power of two times the alignment) and number of directions for `count` charts on a
// page of this side such that one layout costs about `affordable` looks at words at most.
struct GridChoice {
  std::int32_t cell = 1;
  std::uint32_t directions = 4;
};
double layout_cost(std::size_t count, double side_cells, std::uint32_t directions);
GridChoice choose_grid(std::size_t count, std::int32_t page_side, std::int32_t alignment,
                       std::uint32_t rotations, double affordable);

// One task a chain, on up to context.threads threads.
void parallel_chains(const Context& context, std::size_t chains,
                     const std::function<void(std::size_t)>& run);

}  // namespace atlas::pack
