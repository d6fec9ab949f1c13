// Where an instance of a mesh lies on the pages of an atlas.
#pragma once

#include <cstdint>

#include "libatlas/core/vec.h"

namespace atlas {

// The instance has uv * scale + offset of its page, with the mesh's own uv. Neither turns nor
// mirrors it. All instances of a mesh have other places.
struct MeshInstance {
  std::uint32_t page = 0;
  Vec2f scale{1, 1}, offset{0, 0};  // 0..1 over the page, origin bottom left
};

}  // namespace atlas
