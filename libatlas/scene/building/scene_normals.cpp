// Turns the normals of a file, whatever it holds, into unit vectors.
#include <fmt/format.h>

#include <cmath>
#include <unordered_map>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/scene/building/scene_builder.h"

namespace atlas {
namespace {

constexpr double kKept = 1e-3;  // values this close to unit length stay as the file has them

// Returns false if the normal has no direction.
bool make_unit(Vec3f& normal) {
  const glm::dvec3 n = to_dvec(normal);
  const double length = glm::length(n);
  if (!(length > 0) || !std::isfinite(length)) return false;
  if (std::abs(length - 1) > kKept) normal = from_glm(glm::vec3(n / length));
  return true;
}

}  // namespace

// Some exporters give triangles without area normals of length 0, and viewers draw surfaces without
// a normal black. Therefore each such normal becomes the area-weighted mean normal of its
// triangles.
void SceneBuilder::place_normals(Scene& scene) {
  if (normal_indices_.empty()) return;
  std::unordered_map<std::uint32_t, glm::dvec3> unusable;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (make_unit(normals[i])) continue;
    unusable.emplace(static_cast<std::uint32_t>(i), glm::dvec3(0));
    defects.add(DefectKind::normal_unusable,
                [&] { return fmt::format("{}: normal {}", file, i + 1); });
  }
  for (std::size_t k = 0; !unusable.empty() && k < normal_indices_.size(); ++k) {
    const auto at = unusable.find(normal_indices_[k]);
    if (at == unusable.end()) continue;
    const std::uint32_t* v = &scene.indices[k / 3 * 3];
    const glm::dvec3 a = to_dvec(scene.positions[v[0]]);
    at->second +=
        glm::cross(to_dvec(scene.positions[v[1]]) - a, to_dvec(scene.positions[v[2]]) - a);
  }
  for (const auto& [i, sum] : unusable) {
    const double length = glm::length(sum);
    normals[i] = length > 0 ? from_glm(glm::vec3(sum / length)) : Vec3f{0, 0, 1};
  }
  scene.normals = std::move(normals);
  scene.normal_indices = std::move(normal_indices_);
}

}  // namespace atlas
