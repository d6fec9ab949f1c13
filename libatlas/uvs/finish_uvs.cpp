#include "libatlas/uvs/finish_uvs.h"

#include <algorithm>

#include "libatlas/uvs/draw_once.h"
#include "libatlas/uvs/round_uvs.h"
#include "libatlas/uvs/thin_uvs.h"

namespace atlas {
namespace {

// A texel of the longest page, as a share of that page.
double texel_of_longest(std::span<const Extent> pages) {
  std::int32_t longest = 1;
  for (const Extent& page : pages) longest = std::max({longest, page.width, page.height});
  return 1.0 / longest;
}

// Once a chart is moved, the texels that it owns for its mip levels may reach a texel further.
bool may_move(const FinishOptions& options) {
  return options.mip_levels == 0 || options.padding > gutter_pad(options.mip_levels);
}

// Puts the uvs of charts that stay where they lay. Returns how many triangles are thin then.
std::size_t put_back(const PlacedCharts& placed, std::span<const std::uint32_t> corners,
                     std::vector<Vec2f>& uvs) {
  const std::vector<Vec2d> exact = page_uvs(placed);
  for (std::size_t c = 0; c < placed.charts.charts.size(); ++c) {
    if (!placed.stays(c)) continue;
    const Chart& chart = placed.charts.charts[c];
    for (std::uint32_t i = chart.first_uv; i < chart.first_uv + chart.uv_count; ++i)
      uvs[i] = rounded_uv(to_glm(exact[i]));
  }
  std::size_t thin = 0;
  for (std::size_t t = 0; t < corners.size() / 3; ++t)
    thin += is_thin(corners.subspan(3 * t).first<3>(), uvs);
  return thin;
}

}  // namespace

FinishedUvs finish_uvs(const PlacedCharts& placed, std::span<const std::uint32_t> corners,
                       const FinishOptions& options, const Context& context) {
  FinishedUvs finished;
  finished.placements.assign(placed.placements.begin(), placed.placements.end());
  const bool lit = options.baked || options.mip_levels > 0;
  const double farthest = lit ? texel_of_longest(placed.pages) : 1;
  finished.thin_triangles = round_uvs(page_uvs(placed), corners, finished.uvs, farthest);
  if (!placed.kept_texels.empty())
    finished.thin_triangles = put_back(placed, corners, finished.uvs);
  if (options.baked) return finished;
  const DrawnTwice drawn = may_move(options) ? draw_once(placed, corners, finished.uvs, context)
                                             : drawn_twice(placed, corners, finished.uvs, context);
  finished.texels_drawn_twice = drawn.after;
  for (const DrawnTwice::Move& move : drawn.moves) {
    Vec2d& offset = finished.placements[move.chart].offset;
    offset = {offset.x + move.texels.x, offset.y + move.texels.y};
  }
  return finished;
}

}  // namespace atlas
