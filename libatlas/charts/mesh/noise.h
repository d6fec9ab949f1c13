// Internal: scan noise, and normals without it.
#pragma once

#include "libatlas/charts/mesh/topology.h"
#include "libatlas/core/context.h"

namespace atlas {

// Fills Topology::calm_normals if any piece of many triangles folds at most of its edges, as noise
// along the normals does and smooth surfaces of that size do not: in such pieces normals are
// averaged with their neighbours', less across folds that are sharp even so (after bilateral
// filtering of normals; Zheng et al. 2011). Linear.
void calm_noise(Topology& topology, const Context& context);

}  // namespace atlas
