// Internal: the neighbours across edges of two triangles, by the vertices alone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace atlas {

// Returns, for each half-edge, the one on the other side of its edge, or kNoIndex unless exactly
// two triangles have the edge, in whichever direction. `corners` has the vertices of triangles,
// each less than `vertices`. Takes linear time.
std::vector<std::uint32_t> pair_links(std::span<const std::uint32_t> corners, std::size_t vertices);

}  // namespace atlas
