// Internal: from charts on pages to the mesh that exporters write.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libatlas/bake/placement.h"
#include "libatlas/charts/charts.h"
#include "libatlas/exporters/world.h"
#include "libatlas/pack/pack.h"
#include "libatlas/scene/scene.h"

namespace atlas {

// The triangles to write: the scene's own or the coarser mesh's. What the spans point at must
// outlive it.
struct WorldMesh {
  std::span<const std::uint32_t> indices;         // 3 a triangle, into Scene::positions
  std::span<const std::uint32_t> uv_indices;      // 3 a triangle, into ChartSet::uvs
  std::span<const std::uint32_t> triangle_chart;  // 1 a triangle
};

// The scene's own triangles as its charts have them: those that cutting had to turn round are
// turned. `indices` (Scene::indices) and `charts` must outlive it.
class ChartedMesh {
 public:
  ChartedMesh(std::span<const std::uint32_t> indices, const ChartSet& charts);
  WorldMesh view() const { return mesh_; }

 private:
  std::vector<std::uint32_t> indices_, uv_indices_;  // only where the charts turned triangles round
  WorldMesh mesh_;
};

// The parts that together say where a chart's uv lies on its page: every placement names a chart of
// the set and a page of these.
struct PlacedCharts {
  const ChartSet& charts;
  std::span<const ChartPlacement> placements;  // 1 a chart
  std::span<const Extent> pages;
};

// 1 a uv of the charts: where it lies on its chart's page, as a fraction of the page's sides
// (origin bottom left); exact, see round_uvs.h.
std::vector<Vec2d> page_uvs(const PlacedCharts& placed);

struct AssembledWorld {
  World world;
  std::size_t thin_triangles = 0;  // turned over or closed by their uvs as floats: see round_uvs.h
};

// One world page an atlas page, triangles in input order within each; uvs as page fractions. With
// `baked` the pages hold light by now: rounding moves no uv farther than a texel of the largest,
// which the gutters forgive at all but the coarsest of their mip levels.
AssembledWorld assemble_world(const Scene& scene, const PlacedCharts& placed, const WorldMesh& mesh,
                              bool baked);

// What whoever uses a world with some has to know.
std::string thin_triangles_text(std::uint64_t thin, std::uint64_t triangles);

// Turns a world of one page into one that keeps its scene (World::scene), all corners as the scene
// has them: triangles that cutting had to turn round face again as they did, since the scene's
// normals and materials are for that side; their uvs turn clockwise.
void keep_scene(const Scene& scene, const ChartSet& charts, World& world);

}  // namespace atlas
