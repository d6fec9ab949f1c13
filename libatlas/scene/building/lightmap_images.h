// Internal: reads the images of a scene's lightmap.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/scene/building/scene_builder.h"

namespace atlas {

// What a file says of its lightmap. Names are those of files beside it, encoded as in uris or
// plain.
struct LightmapImages {
  std::vector<std::string> images, linear;  // a page each; either may be empty
  // > 0, the light that `images` show as 1. Nothing: unknown, taken as 1.
  std::optional<float> white = {};
};

// Returns the file that such a name in `file` means.
std::filesystem::path lightmap_path(const std::string& name, const std::filesystem::path& file);

// Notes the images as files that the scene names. Those that are read, too, will be listed as such
// only.
void note_lightmap(const LightmapImages& named, SceneBuilder& builder);

// Reads the pages that are used: the linear images if all can be read, otherwise the others; that
// some cannot is a defect. Pages that are not used stay empty. Error: the reason why the pages
// cannot be read from either.
Result<std::vector<ImageF>> read_lightmap(const LightmapImages& named,
                                          const std::vector<bool>& used, SceneBuilder& builder,
                                          const Context& context);

}  // namespace atlas
