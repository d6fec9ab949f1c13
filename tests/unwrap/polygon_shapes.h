// Meshes of polygons for tests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libatlas/core/vec.h"
#include "libatlas/unwrap/atlas.h"
#include "tests/support/shapes.h"

namespace atlas::test {

struct PolygonShape {
  std::vector<Vec3f> positions = {};
  std::vector<std::uint32_t> indices = {};  // polygon after polygon
  std::vector<std::uint32_t> sizes = {};

  void add(const std::vector<std::uint32_t>& corners);
  StridedMesh view() const;
};

// Joins the two triangles of each quad that Shape::add_quad() has made; others stay triangles.
PolygonShape quads_of(const Shape& shape);
// The dual of a closed surface: a polygon around each vertex, through the triangles' centroids.
PolygonShape dual_of(const Shape& shape);
// A flat comb with this many teeth as one concave polygon.
PolygonShape comb(std::uint32_t teeth);
// A square tube of bricks, rows * columns, in which the corners
// of a brick lie on the long sides of others and belong to their outlines. 4 divides 2 * columns.
PolygonShape bricks(std::uint32_t rows, std::uint32_t columns);
// A flat square with a square hole as one polygon, joined by an edge there and back.
PolygonShape frame();

}  // namespace atlas::test
