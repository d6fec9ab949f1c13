#include "tests/support/reordered.h"

#include <utility>

#include "libatlas/core/random.h"

namespace atlas::test {

Reordered reordered(const Shape& shape, std::uint64_t seed) {
  Random random(seed);
  const auto shuffled = [&](std::size_t count) {
    std::vector<std::uint32_t> order(count);
    for (std::uint32_t i = 0; i < count; ++i) order[i] = i;
    for (std::uint32_t i = 1; i < count; ++i) std::swap(order[i], order[random.below(i + 1)]);
    return order;
  };
  Reordered result{{shape.name, shape.positions, {}}, {}};
  const std::vector<std::uint32_t> vertex = shuffled(shape.positions.size());
  for (std::size_t v = 0; v < vertex.size(); ++v)
    result.shape.positions[vertex[v]] = shape.positions[v];
  for (const std::uint32_t t : shuffled(shape.triangle_count())) {
    const std::uint32_t turn = random.below(3);
    for (std::uint32_t k = 0; k < 3; ++k) {
      result.corner.push_back(3 * t + (k + turn) % 3);
      result.shape.indices.push_back(vertex[shape.indices[result.corner.back()]]);
    }
  }
  return result;
}

}  // namespace atlas::test
