// Internal: uvs for a glTF scene whose meshes are unwrapped once each, however often they are
// shown.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"
#include "libatlas/pipeline/export_job.h"
#include "libatlas/unwrap/instance.h"
#include "libatlas/unwrap/unwrap.h"

namespace atlas {

struct MeshUvsOfScene {
  std::vector<Vec2f> uvs = {};                 // 0..1 over the square of their mesh
  std::vector<std::uint32_t> uv_indices = {};  // three per triangle of the scene
  // One per place of the scene's source: where its mesh's square lies on the pages. Empty with
  // MeshUvs::meshes.
  std::vector<MeshInstance> instances = {};
  UnwrappedMesh all = {};  // its pages and what was measured
};

// For options whose mesh_uvs are not those of places; reports what was measured. Errors: those of
// unwrap_mesh(); bad_option for a scene that was not read from glTF with ReadOptions::rest;
// unsupported where a mesh is shown with other triangles in two places.
Result<MeshUvsOfScene> unwrap_meshes_once(ExportJob& job);

}  // namespace atlas
