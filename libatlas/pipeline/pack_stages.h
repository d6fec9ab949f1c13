// Internal: the stage of an export that lays charts out on pages.
#pragma once

#include "libatlas/core/status.h"
#include "libatlas/pipeline/export_job.h"
#include "libatlas/pipeline/suit_pages.h"

namespace atlas {

// Lays out charts with light, which are cut where pages would else stay half empty (suit_pages).
// Raises report.mip_levels where there is room. Errors: those of lay_out_pages() and suit_pages().
Result<PackedCharts> pack_lit(ExportJob& job, SizedCharts sized);

// Lays out charts without light, filling the pages (fill_pages). Errors: those of fill_pages();
// no_solution if a density was asked for that the pages have no room for.
Result<PackedCharts> pack_plain(ExportJob& job, ChartSet charts);

}  // namespace atlas
