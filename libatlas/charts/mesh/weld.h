// Internal: welds the vertices of a mesh that lie at one place.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/vec.h"

namespace atlas {

struct WeldedVertices {
  double scale = 1;                   // the power of two that scales the largest extent into [1, 2)
  std::vector<Vec3f> points;          // one per place, in input units
  std::vector<std::uint32_t> source;  // one per place: the first input vertex that lies there
  // One per input vertex; kNoIndex if no triangle uses it. Empty if indices are those of places.
  std::vector<std::uint32_t> place;
};

// Returns, for each of `count` vertices, whether any triangle uses it.
std::vector<std::uint8_t> used_vertices(std::span<const std::uint32_t> indices, std::size_t count);

// Welds vertices whose positions are bitwise equal once coordinates that are mere rounding have
// become 0 (drop_rounding()), and whose objects are equal (one per vertex, or empty: all are).
// Places are numbered in input order. Takes linear time.
WeldedVertices weld_vertices(std::span<const Vec3f> positions, std::span<const std::uint8_t> used,
                             std::span<const std::uint32_t> objects = {});

}  // namespace atlas
