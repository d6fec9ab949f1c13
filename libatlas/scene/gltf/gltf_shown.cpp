#include "libatlas/scene/gltf/gltf_shown.h"

#include "libatlas/scene/gltf/gltf_source.h"

namespace atlas {

std::vector<ShownMesh> shown_meshes(const Scene& scene) {
  std::vector<ShownMesh> shown;
  if (!scene.source) return shown;
  for (const GltfPlace& place : scene.source->places) {
    shown.push_back({static_cast<std::size_t>(place.mesh), {}});
    for (const GltfShownPrimitive& p : place.primitives)
      shown.back().parts.push_back(
          {p.first_position, p.positions, p.first_triangle, p.triangles, p.mirrored});
  }
  return shown;
}

}  // namespace atlas
