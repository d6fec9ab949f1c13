// Internal: several unwrapped meshes as one.
#pragma once

#include <cstddef>

#include "libatlas/unwrap/unwrap.h"

namespace atlas {

// Appends a mesh whose vertices are counted from `first_position` in the whole. Its pages,
// densities and utilization are not taken over.
void append_unwrapped(UnwrappedMesh part, std::size_t first_position, UnwrappedMesh& whole);

}  // namespace atlas
