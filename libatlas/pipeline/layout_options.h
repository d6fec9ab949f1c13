// Internal: what an export asks of its pages.
#pragma once

#include "libatlas/charts/charts.h"
#include "libatlas/pipeline/export_options.h"
#include "libatlas/pipeline/page_layout.h"

namespace atlas {

// `bake`: whether pages get images, whose gutters and smallest charts depend on their mip levels;
// else plain uvs, for which a single page grows with the number of charts where that is asked for
// (ExportOptions::larger_plain_page).
LayoutOptions layout_options(const ChartSet& charts, const ExportOptions& options, bool bake);

}  // namespace atlas
