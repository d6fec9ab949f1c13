// Internal: returns the part of the fragment shader that looks a point up in shadow maps.
#pragma once

#include <string>

#include "libatlas/view/shaders.h"

namespace atlas {

// Returns text that declares the maps and `float visibility(vec3 point, float depth_bias)`, which
// reads the uniform block `frame` of shaders.cpp. Only for features.shadow != none.
std::string shadow_text(const ShaderFeatures& features);

}  // namespace atlas
