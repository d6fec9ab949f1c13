// Internal: finds which surface samples are seen from places where people can stand.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/vec.h"

namespace atlas {

// Returns the indices of the samples that observers see, one for each line of sight. The observers
// stand at random points in the empty space of the samples' box. As people do, each looks along the
// longest of 16 random lines of sight, and sees the samples within 50 degrees of it. The half of
// them that sees less far than the others is left out. Surfaces in narrow gaps are hardly seen.
//
// Rays are marched through a grid of voxels of 2.5 sample distances or more. This approximates
// visibility, needs no ray-tracing structure, and costs the same for any triangle count. A point
// from which fewer than five rays in eight meet a sample is outside the scene, and is skipped. If
// all points are skipped, or so many of the first eighth that far fewer than `needed` samples would
// be seen, the result is empty: a scene without rooms costs an eighth of the time. `area` is the
// surface that the samples represent evenly. The result is deterministic and does not depend on the
// scale.
std::vector<std::uint32_t> seen_samples(std::span<const Vec3f> positions, double area,
                                        std::size_t needed);

}  // namespace atlas
