// The charts that a mesh's own uvs make.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libatlas/core/vec.h"
#include "libatlas/scene/scene.h"

namespace atlas::app {

// The uv charts of a mesh: triangles joined by common texcoord indices, or by equal texcoords at
// one place, since many programs write each corner's own.
struct UvCharts {
  std::vector<std::uint32_t> chart;                 // 1 a triangle, or kNone
  std::vector<std::uint32_t> same;                  // 1 a texcoord: one that is equal, or itself
  std::vector<std::vector<std::uint32_t>> members;  // triangles a chart
  std::vector<std::vector<Vec2d>> corners;          // 3 a triangle, texels at scale 1
  std::size_t without_uv = 0, without_area = 0;
  static constexpr std::uint32_t kNone = 0xffffffffu;
};

// All but `corners`.
UvCharts find_charts(const Scene& scene);

// Scales every chart so that its area is that of its surface, and all together fill the pages:
// fills `corners` and `without_area`.
void make_uniform(const Scene& scene, double page_area, UvCharts& charts);

}  // namespace atlas::app
