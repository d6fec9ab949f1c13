// Uvs of polygons, one per corner, from those of the triangles that they were cut into.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/polygon.h"

namespace atlas {

struct PolygonUvs {
  // One per corner of the polygons, in their own order: what the triangles have there.
  std::vector<std::uint32_t> corners = {};
  // The polygons that have several uvs at a corner, ascending: a seam runs through them, and
  // `corners` has those of one part only. They can be drawn as their triangles.
  std::vector<std::uint32_t> cut = {};
};

// `triangle_uvs`: three per triangle of the polygons; numbers that are equal where uvs are.
PolygonUvs polygon_uvs(const PolygonCorners& polygons, std::span<const std::uint32_t> triangle_uvs);

}  // namespace atlas
