// The same mesh in another order.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/support/shapes.h"

namespace atlas::test {

// A mesh whose triangles and vertices come in another, random order, and whose triangles begin with
// another corner.
struct Reordered {
  Shape shape;
  std::vector<std::uint32_t> corner;  // one per corner: its number in the original
};
Reordered reordered(const Shape& shape, std::uint64_t seed);

}  // namespace atlas::test
