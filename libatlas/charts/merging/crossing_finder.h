// Internal: whether the border of a coarse chart crosses itself, asked for at every trial.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/vec.h"

namespace atlas {

enum class Crossing { none, shallow, deep };

// Keeps its memory from call to call.
class CrossingFinder {
 public:
  // The deepest crossing. `border`: edges as pairs of places in `uvs`; those with a common end do
  // not cross. A crossing is deep if one of its edges must move by more than `deep`, uv units, for
  // it to go. Edges nearer to each other than a thousandth of that cross, too: in what unrolls
  // exactly equal sides come to lie upon each other, and rounding would decide.
  Crossing find(std::span<const std::array<std::uint32_t, 2>> border, std::span<const Vec2d> uvs,
                double deep);

  // Left, right, low and high sides, one after the other for all boxes, in so many entries each.
  struct Boxes {
    std::vector<double> sides;
    std::size_t stride = 0;
  };

 private:
  Boxes edges_, groups_;
};

}  // namespace atlas
