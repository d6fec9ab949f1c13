// Internal: the triangles that an export writes, with their finished uvs.
#pragma once

#include <vector>

#include "libatlas/charts/charted_mesh.h"
#include "libatlas/core/context.h"
#include "libatlas/core/vec.h"
#include "libatlas/pipeline/export_options.h"
#include "libatlas/report/export_report.h"
#include "libatlas/scene/scene.h"
#include "libatlas/simplify/simplify.h"
#include "libatlas/unwrap/page_layout.h"

namespace atlas {

// The results of the stages before. All of them must outlive what is made from them.
struct MeshToFinish {
  const Scene& scene;
  const ExportOptions& options;
  const ChartSet& charts;
  const PageLayout& layout;
  const SimplifiedMesh* coarse = nullptr;  // null: the scene's own triangles are written
  bool baked = false;                      // the pages hold light
};

struct FinishedMesh {
  ChartedMesh fine;
  WorldMesh mesh;          // of `fine` or of MeshToFinish::coarse
  std::vector<Vec2f> uvs;  // one per uv of the charts: 0..1 over its page
};

// Finishes the uvs of the triangles that are written (finish_uvs.h), and adds to the report how
// many there are and what rounding did to them. The result is incomplete if cancelled.
FinishedMesh finish_mesh(const MeshToFinish& made, ExportReport& report, const Context& context);

}  // namespace atlas
