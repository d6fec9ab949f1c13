// Internal: the codecs of EXT_meshopt_compression, and the quantisation of meshes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libatlas/core/vec.h"

namespace atlas {

// Returns vertices in the mode ATTRIBUTES, without loss. `stride` is a multiple of 4, at most 256.
std::string pack_vertices(const void* data, std::size_t count, std::size_t stride);

// Returns indices in the mode TRIANGLES: triangles keep their order, and their corners the cyclic
// one.
std::string pack_triangles(std::span<const std::uint32_t> indices);

// Reorders triangles and vertices so that they pack well and draw fast. `indices` has three a
// triangle. Returns where each vertex goes.
std::vector<std::uint32_t> order_for_packing(std::vector<std::uint32_t>& indices,
                                             std::size_t vertices);

// Positions as whole numbers of 16 bits (KHR_mesh_quantization): a position is low + step * number.
struct PositionGrid {
  Vec3f low = {};
  float step = 1;  // the same along all axes

  std::array<std::uint16_t, 4> at(const Vec3f& position) const;  // the fourth is 0
};

// Returns the grid of a box of all positions; nothing if it would move a position by more than
// `slip` along an axis.
std::optional<PositionGrid> position_grid(std::span<const Vec3f> positions, double slip);

}  // namespace atlas
