// Internal: the choice of the grains that cells grow from.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/charts/cells/cells.h"
#include "libatlas/charts/cells/grains.h"

namespace atlas {

// The seeds of a piece are contiguous and numbered by their place in the mesh, the last grain's
// first.
struct CellSeeds {
  std::vector<std::uint32_t> grain;  // one per seed
  std::vector<glm::vec3> normal;     // one per seed: the mean normal of its grains
  std::vector<std::uint32_t> owner;  // one per grain: its seed
};

// Chooses the seeds of all pieces. Large pieces without handles or holes begin with seeds a few
// grains apart. Then follow farthest-point sampling on the grains by cell_distance(), more seeds
// where normals deviate too far, and two recentring steps. After cancellation the result must not
// be used.
CellSeeds choose_seeds(const CellInput& input, const Grains& grains, const CellOptions& options,
                       const Context& context);

}  // namespace atlas
