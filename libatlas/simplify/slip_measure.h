// Internal: the exact slip and turn of one coarse triangle against the fine chart.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libatlas/simplify/fine_chart.h"

namespace atlas::simplify {

struct SlipLimits {
  double slip = 0;  // scene units
  double turn = 0;  // radians
};

// Coarse and fine surface are linear over the pieces into which the coarse triangle and the fine
// ones cut each other in uv, so the largest distance is at a corner of a piece: these are all
// visited, spreading over the fine triangles from the coarse triangle's corners.
class SlipMeasure {
 public:
  SlipMeasure(const FineChart& fine, const VertexPoints& points);

  // Returns false as soon as a limit is exceeded (or, for a triangle away from the border, when the
  // fine chart does not cover it). Otherwise sets `found` to slip and turn of the triangle.
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
  double turn_cosine_ = 1;  // of the turn found so far
  double covered_ = 0;      // of the coarse triangle, 1 is all
};

}  // namespace atlas::simplify
