#include "libatlas/pipeline/assemble_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "libatlas/uvs/polygon_uvs.h"

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

std::size_t take_polygons(const Scene& scene, const PlacedCharts& placed, World& world) {
  const PolygonCorners& faces = scene.polygons;
  const ChartSet& charts = placed.charts;
  const PolygonUvs uvs = polygon_uvs(faces, charts.triangle_uv);
  std::vector<std::uint32_t> vertex(faces.first.back());
  for (std::size_t i = 0; i < faces.triangles.size(); ++i)
    vertex[faces.triangles[i]] = scene.indices[i];
  std::vector<bool> flipped(scene.triangle_count(), false);
  for (const std::uint32_t t : charts.flipped_triangles) flipped[t] = true;
  for (Page& page : world.pages) page = {};
  // A face of corners that have these positions and uvs; the first triangle is one of its own.
  const auto add = [&](std::size_t triangle, std::vector<std::array<std::uint32_t, 2>> corners) {
    if (flipped[triangle]) std::reverse(corners.begin() + 1, corners.end());
    const ChartPlacement& placement = placed.placements[charts.triangle_chart[triangle]];
    Page& page = world.pages[std::size_t(placement.page)];
    for (const auto& [position, uv] : corners) {
      page.indices.push_back(position);
      page.uv_indices.push_back(uv);
    }
    page.face_sizes.push_back(std::uint32_t(corners.size()));
  };
  std::vector<std::array<std::uint32_t, 2>> corners;
  for (std::size_t t = 0, end = 0; t < scene.triangle_count(); t = end) {
    const std::uint32_t face = faces.polygon[t];
    while (end < scene.triangle_count() && faces.polygon[end] == face) ++end;
    const bool cut = std::binary_search(uvs.cut.begin(), uvs.cut.end(), face);
    for (std::size_t own = t; cut && own < end; ++own) {
      corners.clear();
      for (std::size_t i = 3 * own; i < 3 * own + 3; ++i)
        corners.push_back({scene.indices[i], charts.triangle_uv[i]});
      add(own, corners);
    }
    corners.clear();
    for (std::uint32_t c = faces.first[face]; c < faces.first[face + 1]; ++c)
      corners.push_back({vertex[c], uvs.corners[c]});
    if (!cut) add(t, corners);
  }
  return uvs.cut.size();
}

void make_tiles(const PlacedCharts& placed, World& world) {
  Page all;
  for (const Page& page : world.pages) {
    all.indices.insert(all.indices.end(), page.indices.begin(), page.indices.end());
    all.uv_indices.insert(all.uv_indices.end(), page.uv_indices.begin(), page.uv_indices.end());
    all.face_sizes.insert(all.face_sizes.end(), page.face_sizes.begin(), page.face_sizes.end());
  }
  world.pages.clear();
  world.pages.push_back(std::move(all));
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
