#include "libatlas/pack/outlines/shape_check.h"

#include <fmt/format.h>

#include <cmath>

namespace atlas::pack {

Status check_shapes(std::span<const ChartShape> shapes) {
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const ChartShape& s = shapes[i];
    const std::size_t n = s.triangles.empty() ? s.corners.size() : s.triangles.size();
    if (n % 3 != 0)
      return {ErrorCode::bad_input,
              fmt::format("outline: shape {} has {} corners (three a triangle)", i, n)};
    for (const Vec2d& p : s.corners)
      if (!(std::abs(p.x) < 1e9) || !(std::abs(p.y) < 1e9))
        return {ErrorCode::bad_input, fmt::format("outline: shape {} has a corner at {}, {} "
                                                  "(finite and below 1e9 texels, please)",
                                                  i, p.x, p.y)};
    for (std::uint32_t k : s.triangles)
      if (k >= s.corners.size())
        return {ErrorCode::bad_input,
                fmt::format("outline: shape {} refers to corner {} of {}", i, k, s.corners.size())};
  }
  return {};
}

Status check_rotations(std::uint32_t rotations) {
  if (rotations == 1 || rotations == 2 || (rotations > 0 && rotations <= 64 && rotations % 4 == 0))
    return {};
  return {ErrorCode::bad_option, fmt::format("outline: rotations is {} (1, 2, 4 or a multiple of 4 "
                                             "up to 64)",
                                             rotations)};
}

}  // namespace atlas::pack
