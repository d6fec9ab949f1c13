// Internal: whether a mesh can be added to an atlas.
#pragma once

#include <cstddef>
#include <span>

#include "libatlas/core/status.h"
#include "libatlas/unwrap/atlas.h"

namespace atlas {

// Checks a mesh that is to be the one with this number, and its relative density. Error: bad_input.
Status check_mesh(const StridedMesh& mesh, std::size_t number, float density);

// Checks the instances of such a mesh. Errors: bad_input, unsupported.
Status check_instances(std::size_t number, std::size_t count, std::span<const float> densities);

}  // namespace atlas
