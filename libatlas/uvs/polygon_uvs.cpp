#include "libatlas/uvs/polygon_uvs.h"

#include "libatlas/core/no_index.h"

namespace atlas {

PolygonUvs polygon_uvs(const PolygonCorners& polygons,
                       std::span<const std::uint32_t> triangle_uvs) {
  PolygonUvs uvs;
  if (polygons.count() == 0) return uvs;
  uvs.corners.assign(polygons.first.back(), kNoIndex);
  for (std::size_t i = 0; i < polygons.triangles.size(); ++i) {
    std::uint32_t& own = uvs.corners[polygons.triangles[i]];
    if (own == kNoIndex) own = triangle_uvs[i];
    const std::uint32_t polygon = polygons.polygon[i / 3];
    const bool known = !uvs.cut.empty() && uvs.cut.back() == polygon;
    if (own != triangle_uvs[i] && !known) uvs.cut.push_back(polygon);
  }
  return uvs;
}

}  // namespace atlas
