// Internal: the smallest cone around a chart's normals.
#pragma once

#include <cstdint>
#include <span>

#include "libatlas/core/vec.h"

namespace atlas {

struct NormalCone {
  Vec3f axis{0, 0, 1};  // unit length
  double angle = 0;     // largest angle between the axis and a normal, radians, as measured
};

// Returns a cone around normals[ids...], which are unit vectors (zero vectors are skipped). If they
// all lie within an open half-space, it is the smallest cone to about 1e-6 radians: its axis points
// to the centre of the smallest ball around the normals, found on a growing set of extreme ones
// (Badoiu and Clarkson 2003). Otherwise the axis is the direction of their sum. O(n) per round, at
// most a dozen rounds.
NormalCone normal_cone(std::span<const Vec3f> normals, std::span<const std::uint32_t> ids);
// The same for a subset of the normals that `whole` is the cone of, and never wider than `whole`.
// For normals that no half-space contains, the subset's own axis could be worse than the whole's.
NormalCone part_of_cone(std::span<const Vec3f> normals, std::span<const std::uint32_t> ids,
                        const NormalCone& whole);
// The cone around all normals.
NormalCone normal_cone(std::span<const Vec3f> normals);

}  // namespace atlas
