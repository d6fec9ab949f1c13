// Internal: the grains that cells grow from.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/charts/cells/cells.h"
#include "libatlas/charts/cells/grains.h"

namespace atlas {

// Those of a piece are contiguous, numbered by their place in the mesh, the last grain's first.
struct CellSeeds {
  std::vector<std::uint32_t> grain;  // 1 a seed
  std::vector<glm::vec3> normal;     // 1 a seed: the mean of what it stands for
  std::vector<std::uint32_t> owner;  // 1 a grain: its seed
};

// In large pieces without handles or holes seeds a few grains apart; then farthest-point sampling
// on the grains by cell_distance(), seeds for what leans too far from its own, and two recentring
// steps. What cancelling leaves must not be used.
CellSeeds choose_seeds(const CellInput& input, const Grains& grains, const CellOptions& options,
                       const Context& context);

}  // namespace atlas
