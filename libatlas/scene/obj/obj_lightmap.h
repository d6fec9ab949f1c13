// Internal: reads the lightmap that a comment at the head of an OBJ file names.
#pragma once

#include <optional>
#include <string_view>

#include "libatlas/scene/building/lightmap_images.h"

namespace atlas {

// Returns the images that a comment names as lightmap_text() (pipeline/lightmap.h) writes it, or
// nothing if it names none.
std::optional<LightmapImages> lightmap_in_comment(std::string_view line);

// Reads them into the builder, for the texture coordinates of the file. If that fails, it is a
// defect.
void read_obj_lightmap(const LightmapImages& named, SceneBuilder& builder, const Context& context);

}  // namespace atlas
