// Checks what every ChartSet has to fulfil, without using the library's own measures.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/charts/mesh/topology.h"
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
  std::string fault;       // the first violation; empty if there is none
  double stretch_999 = 1;  // largest 99.9 % stretch of a chart, recomputed at the chart's own scale
  double stretch_l2 = 1;   // recomputed for the whole mesh
  double seam = 0;         // recomputed length of the seams, in scene units
  // Largest angle between a triangle's normal and its chart's axis, recomputed.
  double cone_degrees = 0;
};

// Checks that every triangle is in one chart and in that chart's range; that uvs lie in their
// charts' boxes and refer to the corners' positions; that triangles with area are positively
// oriented (tested exactly) once the flipped ones are turned; that no two triangles of a chart
// share inner points (exact separating-axis tests on a grid of buckets); and that sizes and counts
// agree.
ChartFindings check_charts(const MeshView& mesh, const ChartSet& set);

// Returns the charts of a mesh for the given ChartOptions::min_fill. A violation fails the test.
ChartSet checked_charts(const Mesh& mesh, double min_fill = ChartOptions{}.min_fill);

// Returns the topology of a mesh for the default options.
Topology topology_of(const Mesh& mesh);

// Returns the area of the charts divided by the area of their boxes.
double box_fill(const ChartSet& set);

// Returns all numbers of a ChartSet as one string of bytes.
std::string bytes(const ChartSet& set);

}  // namespace atlas::test
