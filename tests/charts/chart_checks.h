// What every ChartSet has to be, found out without the library's own measures.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libatlas/charts/charts.h"
#include "tests/support/shapes.h"

namespace atlas::test {

// A mesh that owns its arrays.
struct Mesh {
  std::vector<Vec3f> positions;
  std::vector<std::uint32_t> indices, materials;
  std::vector<Vec2f> texcoords;
  std::vector<std::uint32_t> texcoord_indices;

  Mesh() = default;
  explicit Mesh(const Shape& shape) : positions(shape.positions), indices(shape.indices) {}
  MeshView view() const { return {positions, indices, materials, {}, texcoords, texcoord_indices}; }
};

struct ChartFindings {
  std::string fault;        // the first broken promise; empty: none
  double stretch_999 = 1;   // largest of a chart, recomputed at the chart's own scale
  double stretch_l2 = 1;    // whole mesh
  double seam = 0;          // recomputed; scene units
  double cone_degrees = 0;  // largest angle to a chart's axis, recomputed
};

// Checks: every triangle in one chart and in that chart's range; uvs lie in their charts' boxes and
// stand for the corners' positions; triangles with area are positively oriented (exact) once the
// flipped ones are turned; no two triangles of a chart share inner points (exact separating-axis
// tests on a grid of buckets); sizes and counts agree.
ChartFindings check_charts(const MeshView& mesh, const ChartSet& set);

// The charts of a mesh with that ChartOptions::min_fill; a fault fails the test.
ChartSet checked_charts(const Mesh& mesh, double min_fill);

// Area of the charts / area of their boxes.
double box_fill(const ChartSet& set);

// All of a ChartSet's numbers in one string of bytes.
std::string bytes(const ChartSet& set);

}  // namespace atlas::test
