// Internal: measures the exact slip and turn of one coarse triangle against the fine chart.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libatlas/simplify/fine_chart.h"

namespace atlas::simplify {

struct SlipLimits {
  double slip = 0;  // scene units in SlipMeasure, texels elsewhere
  double turn = 0;  // radians
};

// The coarse triangle and the fine triangles cut each other into pieces in uv. Both surfaces are
// linear over each piece, so the largest distance is at a corner of a piece. All these corners are
// visited, beginning with the fine triangles at the coarse triangle's corners and spreading from
// there.
class SlipMeasure {
 public:
  SlipMeasure(const FineChart& fine, const VertexPoints& points);

  // Returns false as soon as a limit is exceeded. It also returns false if the fine chart does not
  // cover the triangle and the triangle has no corner on the border. Otherwise it sets `found` to
  // the slip and turn of the triangle.
  bool measure(const std::array<std::uint32_t, 3>& triangle, const SlipLimits& limits,
               SlipLimits& found);

 private:
  struct Coarse;
  void push(std::uint32_t triangle);
  void push_fan(std::uint32_t vertex);
  bool visit(std::uint32_t triangle, const Coarse& coarse, const SlipLimits& limits,
             SlipLimits& found);

  const FineChart& fine_;
  const VertexPoints& points_;
  std::vector<std::uint32_t> stamp_, stack_;
  std::uint32_t epoch_ = 0;
  double turn_cosine_ = 1;  // cosine of the largest turn found so far
  double covered_ = 0;      // share of the coarse triangle that was covered, 1 is all
};

}  // namespace atlas::simplify
