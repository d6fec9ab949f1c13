// Where a viewer should start in a scene that nobody has described.
#pragma once

#include <cstdint>
#include <span>

#include "libatlas/core/context.h"
#include "libatlas/exporters/world.h"

namespace atlas {

struct ViewpointOptions {
  Up up = Up::y;
  double metres_per_unit = 1;  // for the eye height of 1.6 m, used where the rooms are tall enough
  int cells = 96;              // voxels along the longest side of the box, 8 to 512
};

// Chooses a point inside the scene, standing on some floor, with free distance around and the
// longest view ahead; where nothing surrounds any such point (a single object seen from outside),
// a point outside that sees the whole. Positions are relative to World::origin, as given.
// Works on a voxel grid (every triangle marks the cells it passes), so the cost is linear in
// triangles plus a constant; deterministic. Preconditions: indices in range, positions finite.
Viewpoint choose_viewpoint(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices,
                           const ViewpointOptions& options, const Context& context);

}  // namespace atlas
