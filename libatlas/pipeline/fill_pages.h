// Internal: plain uvs on pages of a given shape, which few large charts may leave half empty.
#pragma once

#include "libatlas/charts/charts.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/pipeline/page_layout.h"

namespace atlas {

struct PlainUvs {
  MeshView mesh;
  const ChartOptions& options;  // those of the charts
  double density;               // texels along a unit of length, of all charts
};

// Lays out `charts` with one density. A strip longer than a square page makes all charts small, and
// so does a chart larger than each of several pages. Where pages stay poorly filled, charts are cut
// (cut_to_limits) to ever smaller parts of a page's side, as long as what they cover grows by more
// than further seams are worth; `charts` are then those laid out.
// Not with ChartOptions::min_fill = 0 or keep_uv_charts, nor where everything fits as dense as it
// is wanted. Errors: those of lay_out_pages.
Result<PageLayout> fill_pages(const PlainUvs& uvs, const LayoutOptions& options, ChartSet& charts,
                              const Context& context);

}  // namespace atlas
