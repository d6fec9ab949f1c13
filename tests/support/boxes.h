// Makes rooms and objects of boxes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libatlas/core/vec.h"

namespace atlas::test {

struct Triangles {
  std::vector<Vec3f> positions;
  std::vector<std::uint32_t> indices;
};

// Adds an axis-aligned box whose faces point inward for a room, outward for an object. z is up.
inline void add_box(Triangles& to, Vec3f low, Vec3f high, bool inward) {
  const auto base = std::uint32_t(to.positions.size());
  for (int i = 0; i < 8; ++i) {
    to.positions.push_back(
        {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
  }
  const std::uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                     {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads) {
    for (const auto& [a, b, c] : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
      const std::uint32_t t[3] = {q[a], q[inward ? c : b], q[inward ? b : c]};
      for (const std::uint32_t v : t) to.indices.push_back(base + v);
    }
  }
}

}  // namespace atlas::test
