// A scene in a few numbers, for plans and reports.
#pragma once

#include "libatlas/scene/scene.h"

namespace atlas {

// Over the triangles and the vertices that they use, in scene units; all zero for an empty scene.
struct SceneStatistics {
  Vec3f low, high;      // corners of the box, relative to Scene::origin
  double diagonal = 0;  // of the box
  double area = 0;      // of all triangles
  std::size_t used_vertices = 0;
  std::size_t degenerate_triangles = 0;                // area 0
  double illumination_max = 0, illumination_mean = 0;  // of the largest channel a vertex
  std::size_t unlit_vertices = 0;                      // all channels 0 or less
};

SceneStatistics scene_statistics(const Scene& scene);

}  // namespace atlas
