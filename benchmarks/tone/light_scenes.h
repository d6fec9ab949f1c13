// Scenes whose light is hard to expose, made of the sample generator's parts.
#pragma once

#include <filesystem>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "examples/cabin/cabin_mesh.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/texture/luminance.h"

namespace atlas::bench {

struct LightScene {
  std::string name = {};
  std::filesystem::path file = {};  // z up, metres
  Quantity quantity = Quantity::illuminance;
  // What the file holds, to be looked at by rays; empty for a scene that was not made here.
  cabin::Shell shell = {};
  std::vector<float> luminance = {};  // one a vertex of the shell, luma of what the surface sends
  std::vector<bool> glares = {};      // one a vertex: it is a lamp's, or the sun shines on it
};

// Makes the scenes, and writes them into `folder`, which must exist. Errors: io, cancelled.
Result<std::vector<LightScene>> make_light_scenes(const std::filesystem::path& folder,
                                                  const Context& context);

}  // namespace atlas::bench
