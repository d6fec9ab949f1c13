// Internal: which surface samples are seen from where people can stand.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/vec.h"

namespace atlas {

struct SurfaceSample {
  Vec3f position;
  float value = 0;  // max(R, G, B)
};

// Stands at random points in the empty space of the samples' box, looks along the longest of 16
// random lines of sight, as people do, and returns the values of the samples met within 50 degrees
// of it, those equal to 0 left out. Surfaces in narrow gaps are hardly met.
//
// Rays are marched through a voxel grid of 2.5 sample distances or more: a sketch of visibility
// that needs no ray-tracing structure and costs the same for any triangle count. Points of which
// fewer than five rays in eight meet anything stand outside and are passed over; empty if all do.
// `area` is the surface that the samples stand for, evenly. Deterministic, scale-free.
std::vector<float> seen_values(std::span<const SurfaceSample> samples, double area);

}  // namespace atlas
