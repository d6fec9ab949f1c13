// Internal: the triangles that an export writes, with their finished uvs.
#pragma once

#include <vector>

#include "libatlas/charts/charted_mesh.h"
#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"
#include "libatlas/pipeline/export_job.h"
#include "libatlas/simplify/simplify.h"

namespace atlas {

struct FinishedMesh {
  ChartedMesh fine;
  WorldMesh mesh;          // of `fine` or of the coarse mesh
  std::vector<Vec2f> uvs;  // one per uv of the charts: 0..1 over its page
};

// Finishes the uvs of the triangles that are written, those of `coarse` or, if it is null, the
// scene's own (finish_uvs.h), and adds to the report how many there are and what rounding did to
// them. Charts and coarse mesh must outlive the result. Error: cancelled.
Result<FinishedMesh> finish_mesh(ExportJob& job, const PackedCharts& packed,
                                 const SimplifiedMesh* coarse);

}  // namespace atlas
