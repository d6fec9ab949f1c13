// Internal. A chart of micro-cells, as it is known while charts are merged.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "libatlas/charts/geometry/moments.h"
#include "libatlas/charts/merging/refusal.h"

namespace atlas {

struct CoarseChart {
  std::vector<std::uint32_t> cells;
  std::vector<std::uint32_t> arcs;  // arcs that are not joined, in any order
  Moments moments{};
  glm::dvec3 normal_sum{0};
  double area = 0, perimeter = 0;
  std::size_t slots = 0;      // of its cells
  double energy = 0;          // area times (L2 stretch squared - 1) of its coarse flattening
  double high_area = 0;       // area of that flattening stretched beyond TrialLimits::stretch_high
  double box = 0;             // area of the smallest rectangle around it; 0: not known yet
  int euler = 1;              // Euler characteristic
  bool flat = false;          // all cells in one plane
  bool unrolls = false;       // exactly, without stretch
  std::uint32_t version = 0;  // raised by each merger; candidates of earlier versions are stale
  std::vector<Refusal> refusals;  // each is stored with one of its two charts
};

// Normals count as lying in one plane if 1 - |mean normal| is below this: they then differ by about
// a thousandth of a radian, the noise of float coordinates.
inline constexpr double kFlatSpread = 1e-6;

// For a chart of one cell.
inline bool in_one_plane(const CoarseChart& chart) {
  return 1 - glm::length(chart.normal_sum) / chart.area < kFlatSpread;
}

// Whether both charts lie in one plane.
inline bool coplanar(const CoarseChart& a, const CoarseChart& b) {
  const auto unit = [](const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0 ? v / length : glm::dvec3(0, 0, 1);
  };
  return a.flat && b.flat && 1 - glm::dot(unit(a.normal_sum), unit(b.normal_sum)) < kFlatSpread;
}

}  // namespace atlas
