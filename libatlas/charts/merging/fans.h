// Internal: the data of single fans of a coarse mesh for flattening. Trials of mergers flatten the
// same fans again and again in different unions, so what depends on one fan alone is computed once.
#pragma once

#include <vector>

#include "libatlas/charts/merging/coarse.h"

namespace atlas {

// A slot's contributions to the stiffness of its cell's fan: with the centre, itself and the next
// slot.
struct FanCoupling {
  double centre = 0, own = 0, next = 0;
};

// Data of fan triangles, indexed by slot: a slot's triangle joins its cell's centre, the slot and
// the next one. Inner loops take four triangles of a fan at a time, so they may read kBeyond
// entries beyond its end.
struct Fans {
  static constexpr std::size_t kBeyond = 4;

  explicit Fans(const CoarseMesh& mesh);

  // Area times the gradients, in the triangle's plane, of the hat functions of the slot and of the
  // next one. The centre's is minus their sum. They are 0 where both slots coincide.
  std::vector<double> slot_gradient_x, slot_gradient_y, next_gradient_x, next_gradient_y;
  std::vector<double> area, inverse_area;  // the inverse is finite; 0 where both slots coincide
  std::vector<double> spoke_squared, rim_squared;  // squared lengths: centre to slot, slot to next
  std::vector<FanCoupling> coupling;               // one per slot
  std::vector<double> inverse_pivot;  // one per cell: inverse of the centre's own stiffness
};

}  // namespace atlas
