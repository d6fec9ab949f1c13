// Internal: tests whether the border of a coarse chart crosses itself. Every trial of a merger
// does.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/vec.h"

namespace atlas {

enum class Crossing { none, shallow, deep };

// Keeps its memory between calls.
class CrossingFinder {
 public:
  // Returns the deepest kind of crossing. `border` lists edges as pairs of indices into `uvs`;
  // edges with a common end do not cross. A crossing is deep if one of its edges would have to move
  // by more than `deep` (in uv units) to remove it. Edges closer to each other than a thousandth of
  // that count as crossing, too: where charts unroll exactly, equal sides come to lie on each
  // other, and rounding would decide otherwise.
  Crossing find(std::span<const std::array<std::uint32_t, 2>> border, std::span<const Vec2d> uvs,
                double deep);

  // The left, right, low and high sides of all boxes, one array after the other, `stride` entries
  // each.
  struct Boxes {
    std::vector<double> sides;
    std::size_t stride = 0;
  };

 private:
  Boxes edges_, groups_;
};

}  // namespace atlas
