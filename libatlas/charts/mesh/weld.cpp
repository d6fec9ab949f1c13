#include "libatlas/charts/mesh/weld.h"

#include <algorithm>
#include <cmath>

#include "libatlas/core/bounds.h"
#include "libatlas/core/drop_rounding.h"
#include "libatlas/core/first_index.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

double unit_scale(std::span<const Vec3f> positions, std::span<const std::uint8_t> used) {
  Bounds<glm::vec3> box;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v]) box.add(to_glm(positions[v]));
  }
  const glm::dvec3 extent = glm::dvec3(box.high) - glm::dvec3(box.low);
  const double size = std::max({extent.x, extent.y, extent.z});
  return size > 0 ? std::ldexp(1.0, -std::ilogb(size)) : 1.0;
}

}  // namespace

std::vector<std::uint8_t> used_vertices(std::span<const std::uint32_t> indices, std::size_t count) {
  std::vector<std::uint8_t> used(count, 0);
  for (const std::uint32_t v : indices) used[v] = 1;
  return used;
}

WeldedVertices weld_vertices(std::span<const Vec3f> positions, std::span<const std::uint8_t> used,
                             std::span<const std::uint32_t> objects) {
  WeldedVertices welded;
  welded.scale = unit_scale(positions, used);
  const double size = 1 / welded.scale;
  const std::size_t n = positions.size();
  FirstIndex first(n);
  welded.place.assign(n, kNoIndex);
  for (std::uint32_t v = 0; v < n; ++v) {
    if (!used[v]) continue;
    const Vec3f& at = positions[v];
    const Vec3f p{drop_rounding(at.x, size), drop_rounding(at.y, size), drop_rounding(at.z, size)};
    const std::uint32_t object = objects.empty() ? 0 : objects[v];
    const auto same = [&](std::uint32_t i) {
      return welded.points[i] == p && (objects.empty() || objects[welded.source[i]] == object);
    };
    std::uint32_t& point =
        first.find(hash_words<4>({word_of(p.x), word_of(p.y), word_of(p.z), object}), same);
    if (point == kNoIndex) {
      point = static_cast<std::uint32_t>(welded.source.size());
      welded.source.push_back(v);
      welded.points.push_back(p);
    }
    welded.place[v] = point;
  }
  return welded;
}

}  // namespace atlas
