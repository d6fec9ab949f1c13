#include "libatlas/scene/statistics.h"

#include <algorithm>

#include "libatlas/core/glm_bridge.h"

namespace atlas {

SceneStatistics scene_statistics(const Scene& scene) {
  SceneStatistics result;
  if (scene.indices.empty()) return result;
  std::vector<bool> used(scene.positions.size(), false);
  glm::dvec3 low = to_dvec(scene.positions[scene.indices[0]]), high = low;
  for (std::size_t t = 0; t + 2 < scene.indices.size(); t += 3) {
    glm::dvec3 corners[3];
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t v = scene.indices[t + c];
      corners[c] = to_dvec(scene.positions[v]);
      low = glm::min(low, corners[c]);
      high = glm::max(high, corners[c]);
      used[v] = true;
    }
    const double area =
        glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0])) / 2;
    result.area += area;
    result.degenerate_triangles += area == 0;
  }
  result.low = from_glm(glm::vec3(low));
  result.high = from_glm(glm::vec3(high));
  result.diagonal = glm::length(high - low);
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    ++result.used_vertices;
    if (!scene.lit()) continue;
    const Vec3f& light = scene.illumination[v];
    const double largest = std::max({light.x, light.y, light.z});
    result.illumination_max = std::max(result.illumination_max, largest);
    result.illumination_mean += largest;
    result.unlit_vertices += largest <= 0;
  }
  result.illumination_mean /= double(result.used_vertices);
  return result;
}

}  // namespace atlas
