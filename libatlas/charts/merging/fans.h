// Internal: the shapes that flattening gives the fans of a coarse mesh. Trials of mergers flatten
// the same fans again and again in ever other company, so what a fan alone decides is kept.
#pragma once

#include <vector>

#include "libatlas/charts/merging/coarse.h"

namespace atlas {

// What a slot adds to the stiffness of its cell's fan: with the centre, itself and the next slot.
struct FanCoupling {
  double centre = 0, own = 0, next = 0;
};

// A slot stands for the triangle from its cell's centre to it and the next one. Inner loops take
// four of a fan at a time, and may read so many numbers beyond its end.
struct Fans {
  static constexpr std::size_t kBeyond = 4;

  explicit Fans(const CoarseMesh& mesh);

  // Area times the gradients of the slot's and the next one's hat functions in the triangle's
  // plane; the centre's is minus their sum. 0 where the rim does not advance.
  std::vector<double> slot_gradient_x, slot_gradient_y, next_gradient_x, next_gradient_y;
  std::vector<double> area, inverse_area;  // the inverse is finite; 0 where the rim stands still
  std::vector<double> spoke_squared, rim_squared;  // lengths: centre to slot, slot to next
  std::vector<FanCoupling> coupling;               // 1 a slot
  std::vector<double> inverse_pivot;               // 1 a cell: of its centre's own stiffness
};

}  // namespace atlas
