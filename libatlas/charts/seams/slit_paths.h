// Internal: straightens slits, the seams of charts with themselves.
#pragma once

#include "libatlas/charts/seams/straighten.h"

namespace atlas {

// Replaces each slit by a shorter path (creases count a quarter) within `rings` edges of it, a few
// times, as long as that saves enough. Ends on the chart's border move along it; other ends stay.
// The triangles between both paths change banks, and their frames turn accordingly. Slits that
// topology does not allow to move stay as they are. `options` are as for straighten_borders(), with
// `triangles` empty.
void straighten_slits(const Topology& topology, const StraightenOptions& options,
                      Partition& partition, Frames& frames);

}  // namespace atlas
