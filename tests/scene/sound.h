// Checks what must hold for every scene that a reader returns, however damaged its file was.
#pragma once

#include <algorithm>
#include <cmath>

#include "libatlas/scene/scene.h"

namespace atlas::test {

// Returns whether all indices name positions, and all positions are finite.
inline bool sound(const Scene& scene) {
  const auto named = [&](std::uint32_t i) { return i < scene.positions.size(); };
  const auto finite = [](const Vec3f& p) { return std::isfinite(p.x + p.y + p.z); };
  return std::all_of(scene.indices.begin(), scene.indices.end(), named) &&
         std::all_of(scene.positions.begin(), scene.positions.end(), finite);
}

}  // namespace atlas::test
