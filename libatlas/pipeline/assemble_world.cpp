#include "libatlas/pipeline/assemble_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace atlas {

World assemble_world(const Scene& scene, const PlacedCharts& placed, const WorldMesh& mesh,
                     std::vector<Vec2f> uvs) {
  World world;
  world.origin = scene.origin;
  world.positions = scene.positions;
  world.uvs = std::move(uvs);
  world.pages.resize(placed.pages.size());
  for (std::size_t t = 0; t < mesh.triangle_chart.size(); ++t) {
    const ChartPlacement& placement = placed.placements[mesh.triangle_chart[t]];
    Page& page = world.pages[std::size_t(placement.page)];
    page.indices.insert(page.indices.end(), &mesh.indices[3 * t], &mesh.indices[3 * t] + 3);
    page.uv_indices.insert(page.uv_indices.end(), &mesh.uv_indices[3 * t],
                           &mesh.uv_indices[3 * t] + 3);
    page.charts.push_back(mesh.triangle_chart[t]);
    if (!mesh.one_sided.empty()) page.one_sided.push_back(mesh.one_sided[t]);
  }
  return world;
}

void make_tiles(const PlacedCharts& placed, World& world) {
  Page all;
  for (const Page& page : world.pages) {
    all.indices.insert(all.indices.end(), page.indices.begin(), page.indices.end());
    all.uv_indices.insert(all.uv_indices.end(), page.uv_indices.begin(), page.uv_indices.end());
  }
  world.pages.assign(1, std::move(all));
  world.uv_tiles.resize(world.uvs.size());
  for (const ChartPlacement& placement : placed.placements) {
    const Chart& chart = placed.charts.charts[placement.chart];
    std::fill_n(world.uv_tiles.begin() + chart.first_uv, chart.uv_count,
                std::uint32_t(placement.page));
  }
}

std::string thin_triangles_text(std::uint64_t thin, std::uint64_t triangles) {
  return fmt::format(
      "{} of {} triangles are so thin that their uvs as floats turn them over or close them: other "
      "programs may complain (more pages, or a mesh without slivers)",
      thin, triangles);
}

void keep_scene(const Scene& scene, const ChartSet& charts, World& world) {
  world.pages.assign(1, {});
  world.pages[0].indices = scene.indices;
  world.pages[0].uv_indices = charts.triangle_uv;
  world.scene = &scene;
}

}  // namespace atlas
