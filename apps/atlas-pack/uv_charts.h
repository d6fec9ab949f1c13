// The charts that a mesh's own uvs form.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/core/vec.h"
#include "libatlas/scene/scene.h"

namespace atlas::app {

// The uv charts of a mesh. Triangles are in one chart if they share texcoord indices, or have equal
// texcoords at the same position, since many programs write separate texcoords for each corner.
struct UvCharts {
  std::vector<std::uint32_t> chart;  // 1 per triangle; kNone: without uvs
  std::vector<std::uint32_t> same;   // 1 per texcoord: the first equal one, maybe itself
  std::vector<std::vector<std::uint32_t>> members;  // triangles of each chart
  std::vector<std::vector<Vec2d>> corners;  // of each chart, 3 per triangle, texels at scale 1
  std::size_t without_uv = 0, without_area = 0;
  static constexpr std::uint32_t kNone = 0xffffffffu;
  static constexpr double kFarthest = 1e9;  // corners must be nearer, as pack/outline.h says
};

// Finds the charts: fills all members except `corners` and `without_area`.
UvCharts find_charts(const Scene& scene);

// What the areas of the charts are proportional to.
enum class ChartSizes { surface, given_uvs };

// Scales the charts so that they have these sizes, and all together the area `page_area`, in
// texels. Fills `corners` and `without_area`.
void scale_charts(const Scene& scene, ChartSizes sizes, double page_area, UvCharts& charts);

// Turns the corners of every chart into its smallest box, or along its straight borders
// (param/orient.h), as charts that libatlas makes lie. Packing takes charts as they lie first, and
// those that lie askew keep others from lying straight.
void turn_upright(const Scene& scene, UvCharts& charts, const Context& context);

}  // namespace atlas::app
