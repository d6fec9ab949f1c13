// Internal: the stages of an export that make charts and give them textures.
#pragma once

#include "libatlas/core/status.h"
#include "libatlas/pipeline/export_job.h"
#include "libatlas/pipeline/suit_pages.h"

namespace atlas {

// Measures the light and makes its tone curve. Errors: those of measure_luminance() and
// make_tone_mapping().
Result<SceneLight> expose(ExportJob& job);

// Makes the charts, with seams where `light` (null: none) jumps. Errors: those of make_charts().
Result<ChartSet> cut_charts(ExportJob& job, const SceneLight* light);

// Cuts charts that are longer than half a page (longest_sides). Errors: those of
// wanted_densities() and cut_to_limits().
Status cut_long_charts(ExportJob& job, const SceneLight& light, ChartSet& charts);

// Gives each chart its texture's size, and opens gaps between its parts. Errors: those of
// size_textures(); cancelled.
Result<SizedCharts> size_all_textures(ExportJob& job, const SceneLight& light, ChartSet charts);

}  // namespace atlas
