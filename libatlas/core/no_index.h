// Internal: the index that stands for none.
#pragma once

#include <cstdint>

namespace atlas {

// No vertex, triangle, half-edge or other element. Arrays of indices never have so many elements.
inline constexpr std::uint32_t kNoIndex = 0xffffffffu;

}  // namespace atlas
