// Internal: the numbers of half-edges. Half-edge 3 t + k runs from corner k of triangle t to corner
// (k + 1) % 3; kNoIndex stands for no half-edge, as on the far side of a border.
#pragma once

#include <cstdint>

#include "libatlas/core/no_index.h"

namespace atlas {

inline std::uint32_t next_half_edge(std::uint32_t h) {
  return h % 3 == 2 ? h - 2 : h + 1;
}
inline std::uint32_t previous_half_edge(std::uint32_t h) {
  return h % 3 == 0 ? h + 2 : h - 1;
}

}  // namespace atlas
