// Triangles without uvs are placed beside those that have some.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "libatlas/charts/flattening/newcomers.h"
#include "libatlas/param/local_mesh.h"
#include "tests/support/shapes.h"

namespace atlas::test {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Triangles triangles_of(const Shape& shape) {
  Triangles triangles;
  for (std::size_t i = 0; i < shape.indices.size(); i += 3) {
    triangles.push_back({shape.indices[i], shape.indices[i + 1], shape.indices[i + 2]});
  }
  return triangles;
}

PositionView points_of(const Shape& shape) {
  return {std::span<const Vec3f>(shape.positions), Vec3f{}};
}

// Returns uvs that are twice as large as the shape, and moved.
std::vector<Vec2d> laid_flat(const Shape& shape) {
  std::vector<Vec2d> corners;
  for (const std::uint32_t v : shape.indices) {
    corners.push_back({2.0 * shape.positions[v].x + 1, 2.0 * shape.positions[v].y - 3});
  }
  return corners;
}

TEST(Newcomers, ContinueWhatIsThere) {
  const Shape shape = grid(3, 2);
  const Triangles triangles = triangles_of(shape);
  const std::vector<Vec2d> known = laid_flat(shape);
  for (std::size_t t = 0; t < triangles.size(); ++t) {  // the only triangle with uvs
    std::vector<Vec2d> corners(known.size(), unplaced()), uvs;
    std::copy_n(known.begin() + 3 * t, 3, corners.begin() + 3 * t);
    ASSERT_TRUE(place_newcomers({points_of(shape), triangles}, corners, uvs));
    for (std::size_t i = 0; i < known.size(); ++i) {
      EXPECT_NEAR(uvs[triangles[i / 3][i % 3]].x, known[i].x, 1e-6) << i;
      EXPECT_NEAR(uvs[triangles[i / 3][i % 3]].y, known[i].y, 1e-6) << i;
    }
  }
}

TEST(Newcomers, NeedAnEdge) {
  const Shape shape = grid(3, 2);
  const Triangles all = triangles_of(shape), apart{all.front(), all.back()};
  std::vector<Vec2d> corners = laid_flat(shape), uvs;
  corners.resize(6);
  const LocalMesh mesh{points_of(shape), apart};
  EXPECT_TRUE(place_newcomers(mesh, corners, uvs));
  std::fill(corners.begin() + 3, corners.end(), unplaced());
  EXPECT_FALSE(place_newcomers(mesh, corners, uvs));
}

}  // namespace
}  // namespace atlas::test
