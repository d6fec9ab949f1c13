// Internal: parts of a mesh that no cell reaches beyond.
#pragma once

#include <cstdint>
#include <vector>

namespace atlas {

// Connected regions that bound cells: flat faces (faces.h), or rows of needles (rows.h).
struct Regions {
  std::vector<std::uint32_t> of_triangle;  // one per triangle: its region; kNoIndex: none
  std::vector<double> share;               // one per piece: the share of its area in regions

  // Whether the edge between these triangles bounds a region.
  bool part(std::uint32_t t, std::uint32_t u) const { return of_triangle[t] != of_triangle[u]; }
};

}  // namespace atlas
