// Internal: detects scan noise and computes normals without it.
#pragma once

#include "libatlas/charts/mesh/topology.h"
#include "libatlas/core/context.h"

namespace atlas {

// Fills Topology::calm_normals if any piece of many triangles folds at most of its edges, as noise
// along the normals makes it do; smooth surfaces of that size do not. In such pieces each normal is
// averaged with its neighbours', which weigh less the sharper the fold between them is (after
// bilateral filtering of normals; Zheng et al. 2011). Linear.
void calm_noise(Topology& topology, const Context& context);

// Counts the vertices of the pieces in which calm_noise() finds noise, and the peaks among them,
// see ChartSet::Noise. Linear; does nothing without such pieces.
ChartSet::Noise measure_noise(const Topology& topology, double max_stretch);

}  // namespace atlas
