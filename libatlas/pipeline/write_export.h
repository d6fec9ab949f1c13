// Internal: the last stage of an export, which makes the world and writes it.
#pragma once

#include <vector>

#include "libatlas/charts/charted_mesh.h"
#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"
#include "libatlas/pipeline/bake_pages.h"
#include "libatlas/pipeline/export_job.h"
#include "libatlas/pipeline/mesh_uvs.h"

namespace atlas {

// The results of the stages before. All of them must outlive the call.
struct ExportToWrite {
  const SceneLight* light;  // null: the pages hold none
  const PackedCharts& packed;
  const BakedPages& baked;  // empty without light
  WorldMesh mesh;           // the triangles to write
  std::vector<Vec2f> uvs;   // one per uv of the charts: 0..1 over its page
};

// Draws the pictures that were asked for, writes the world and commits the job's files, which hold
// the pages' images. Adds to the report what was written, what the format had no room for, and
// advice on a place too far from zero and on meshes without new uvs. Errors: bad_input, io,
// cancelled.
Status write_export(ExportJob& job, ExportToWrite made);

// The same for a scene with uvs of its meshes.
Status write_export(ExportJob& job, const MeshUvsOfScene& made);

}  // namespace atlas
