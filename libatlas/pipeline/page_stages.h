// Internal: the stages of an export between packing and writing.
#pragma once

#include "libatlas/core/status.h"
#include "libatlas/pipeline/bake_pages.h"
#include "libatlas/pipeline/export_job.h"
#include "libatlas/simplify/simplify.h"

namespace atlas {

// Bakes the light into the pages, and measures them if that is asked for. Errors: those of
// bake_pages().
Result<BakedPages> bake(ExportJob& job, const SceneLight& light, const PackedCharts& packed);

// Makes the coarser mesh. Errors: those of simplify_charts().
Result<SimplifiedMesh> simplify(ExportJob& job, const PackedCharts& packed);

}  // namespace atlas
