// Chooses where a viewer starts in a scene that has no viewpoint.
#pragma once

#include <cstdint>
#include <span>

#include "libatlas/core/context.h"
#include "libatlas/exporters/world.h"

namespace atlas {

struct ViewpointOptions {
  Up up = Up::y;
  // > 0; for the eye height of 1.6 m, which is used where the rooms are tall enough.
  double metres_per_unit = 1;
  // The least number of voxels along the longest side of the box, 8 to 512. There are more where
  // voxels of 25 cm are smaller, up to a million in all.
  int cells = 96;
  // What each triangle shows on average, as display values from 0 (black) to 255; empty: unknown.
  std::span<const std::uint8_t> light = {};
};

// Chooses a point inside the scene, above a floor, with free space around it and the longest view
// ahead, a person's distance from walls where the room is that wide, and a view of something lit if
// the light is known. If the scene surrounds no such point, or only in hollows of an object that
// take little of its floor plan, chooses a point outside from which the whole scene is seen.
// Positions and the result are relative to World::origin. The scene is examined on a voxel grid, in
// which every triangle marks the cells that it passes, so the cost is linear in the triangles plus
// a constant. The result is deterministic. Preconditions: indices are in range, positions finite,
// `light` empty or as long as the list of triangles.
Viewpoint choose_viewpoint(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices,
                           const ViewpointOptions& options, const Context& context);

}  // namespace atlas
