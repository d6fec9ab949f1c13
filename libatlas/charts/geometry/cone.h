// Internal: the smallest cone around a chart's normals.
#pragma once

#include <cstdint>
#include <span>

#include "libatlas/core/vec.h"

namespace atlas {

struct NormalCone {
  Vec3f axis{0, 0, 1};  // unit
  double angle = 0;     // largest angle between axis and a normal, radians, as measured
};

// Over normals[ids...], which are unit vectors (zero vectors are skipped). While all lie within an
// open half-space, the cone is the smallest to about 1e-6 radians: its axis is the centre of the
// smallest ball around the normals, found on a growing set of extreme ones (Badoiu and Clarkson
// 2003). Otherwise the axis is that of their sum. O(n) a round, a dozen rounds at most.
NormalCone normal_cone(std::span<const Vec3f> normals, std::span<const std::uint32_t> ids);
// The same of a part of what `whole` is the cone of, and nowhere wider than it: of normals that no
// half-space holds another axis may be found than the whole's, and a worse one.
NormalCone part_of_cone(std::span<const Vec3f> normals, std::span<const std::uint32_t> ids,
                        const NormalCone& whole);
// Over all of them.
NormalCone normal_cone(std::span<const Vec3f> normals);

}  // namespace atlas
