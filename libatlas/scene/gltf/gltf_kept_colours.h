// Internal: what COLOR_0 of a glTF file that is kept holds. Includes no tinygltf.
#pragma once

#include <cstdint>

#include "libatlas/scene/scene.h"

namespace atlas {

// The values of COLOR_0 in a file. The format takes it as paint, which multiplies base colours and
// lies within 0 to 1; libatlas and others write light as such colours, too. Colours of unlit
// materials count as none.
enum class GltfColours : std::uint8_t { none, within_one, beyond_one };

struct KeptColours {
  GltfColours values = GltfColours::none;
  bool illuminance = false;  // whether a primitive of the file has _ILLUMINANCE
};

// Returns what the file holds that the scene was read from; none if that is no glTF file that is
// kept (Scene::source), or if its light is from another file.
KeptColours kept_colours(const Scene& scene);

}  // namespace atlas
