// A mesh with its packed uvs, as an OBJ file.
#pragma once

#include <string>
#include <vector>

#include "apps/atlas-pack/uv_charts.h"
#include "libatlas/core/vec.h"
#include "libatlas/pack/fit.h"
#include "libatlas/scene/scene.h"

namespace atlas::app {

struct RepackedMesh {
  const Scene& scene;
  const UvCharts& charts;
  const FitResult& fit;
  std::vector<Vec2d> uvs;  // new uvs, texels from the page's lower left corner, 3 per triangle
};

// Returns the mesh with its new uvs: its objects and normals, and one material per page.
std::string to_obj(const RepackedMesh& mesh, const std::string& material_file);

// Returns the materials that to_obj() names.
std::string to_mtl(const UvCharts& charts, const FitResult& fit);

// Returns what a scene has and to_obj() does not write, in the words of atlas-export.
std::vector<std::string> lost_in_obj(const Scene& scene);

}  // namespace atlas::app
