// Internal: the shapes that flattening gives the fans of a coarse mesh. Trials of mergers flatten
// the same fans again and again in ever other company, so what a fan alone decides is kept.
#pragma once

#include <vector>

#include "libatlas/charts/coarse.h"

namespace atlas {

// The triangle from a cell's centre to a slot and the next one.
struct FanTriangle {
  // Area times the gradients of the slot's and the next one's hat functions in the triangle's
  // plane; the centre's is minus their sum. 0 where the rim does not advance.
  Vec2d slot_gradient, next_gradient;
  double area = 0, inverse_area = 0;  // the inverse is finite; 0 where the rim does not advance
  double spoke_squared = 0, rim_squared = 0;  // lengths: centre to slot, slot to next
};

// What a slot adds to the stiffness of its cell's fan: with the centre, itself and the next slot.
struct FanCoupling {
  double centre = 0, own = 0, next = 0;
};

struct Fans {
  explicit Fans(const CoarseMesh& mesh);
  std::vector<FanTriangle> triangle;  // 1 a slot
  std::vector<FanCoupling> coupling;  // 1 a slot
  std::vector<double> inverse_pivot;  // 1 a cell: of its centre's own stiffness
};

}  // namespace atlas
