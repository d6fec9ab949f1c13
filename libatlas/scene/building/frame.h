// Internal: chooses the origin that a scene's positions are stored relative to.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/vec.h"

namespace atlas {

// Positions in the file's coordinates, and the corners of its triangles.
struct FilePositions {
  std::span<const Vec3d> positions;        // finite where a triangle uses them
  std::span<const std::uint32_t> indices;  // 3 per triangle, into positions
  std::vector<bool> used;                  // 1 per position: whether a triangle does
};

// How positions become floats.
struct Frame {
  Vec3d origin = {};
  double size = 0;  // the extent of what lies there; coordinates below 2^-40 of it are 0

  // Returns the position relative to the origin, as floats, which may be infinite.
  Vec3f stored(const Vec3d& position) const;
};

// What rounding to floats does to the vertices that triangles use.
struct RoundingLoss {
  std::vector<std::uint32_t> moved;   // positions moved by more than 1e-3 of the typical edge
  std::vector<std::uint32_t> closed;  // triangles with corners that differed and no longer do
};

// Returns the length of the diagonal of the box of the used positions.
double diagonal_of_used(const FilePositions& file);

// Chooses the origin by the box of all used positions (see read_scene()). If that loses much to
// rounding, as where a stray triangle at 0 extends the box of a scene far from it, the origin is
// near the median of the used positions instead, provided that fewer of them are then moved.
Frame choose_frame(const FilePositions& file);

RoundingLoss rounding_loss(const FilePositions& file, const Frame& frame);

}  // namespace atlas
