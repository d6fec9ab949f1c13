// Internal: the unit of a glTF file that is written again in metres. Includes tinygltf, so it is
// for .cpp files only.
#pragma once

#include <nlohmann/json.hpp>

#include "libatlas/scene/building/losses.h"

namespace atlas {

// Multiplies by `metres_per_unit` the lengths that the scale of a node does not reach: planes and
// sizes of cameras, ranges of lights, and distances within volumes. Point and spot lights keep the
// illuminance of what they shine on, so their intensities (candela) are multiplied by its square.
// Cameras and lights that nodes outside the shown scene use, too, are copied for those inside.
// Cameras keep the scale that they had: those that are alone at the root stay there, and others get
// nodes of their own. What animations do to such values is counted. The shown scene's nodes must be
// in place (place_kept_meshes), with that which scales them first among the roots.
void scale_kept_lengths(double metres_per_unit, nlohmann::json& document, Losses& losses);

}  // namespace atlas
