// Internal: turns charts on pages into the mesh that exporters write.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libatlas/charts/charted_mesh.h"
#include "libatlas/charts/charts.h"
#include "libatlas/exporters/world.h"
#include "libatlas/scene/scene.h"
#include "libatlas/uvs/page_uvs.h"

namespace atlas {

// Makes one world page per atlas page, with the triangles in input order. `uvs` are fractions of
// the pages, one per uv of the charts.
World assemble_world(const Scene& scene, const PlacedCharts& placed, const WorldMesh& mesh,
                     std::vector<Vec2f> uvs);

// Gives the pages of a world of triangles the scene's faces (Scene::polygons) in their place, each
// on the page of its chart. Returns how many faces stay triangles, since seams cut them.
std::size_t take_polygons(const Scene& scene, const PlacedCharts& placed, World& world);

// Turns the pages of a world without images into UDIM tiles, of which all triangles share one page.
void make_tiles(const PlacedCharts& placed, World& world);

// Returns the message for users of a world with thin triangles.
std::string thin_triangles_text(std::uint64_t thin, std::uint64_t triangles);

// Turns a world of pages or of tiles into one that keeps its scene (World::scene), on one page
// with all corners as the scene has them. Triangles that were reversed for their charts get their
// orientation back, because the scene's normals and materials are for that side. Their uvs are then
// clockwise.
void keep_scene(const Scene& scene, const ChartSet& charts, World& world);

}  // namespace atlas
