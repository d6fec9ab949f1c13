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

// Lays out `charts` with one density. A strip that is longer than a square page, or a chart that is
// larger than each of several pages, makes all charts small. Where pages stay poorly filled by such
// charts, they are cut (cut_to_limits) to ever smaller parts of a page's side, as long as that lets
// the common scale grow by more than what further seams are worth; `charts` are then those laid
// out. Not with ChartOptions::min_fill = 0 or keep_uv_charts, nor where everything fits as dense as
// it is wanted, nor on a page that may take any shape (LayoutOptions::free_aspect). Errors: those
// of lay_out_pages.
Result<PageLayout> fill_pages(const PlainUvs& uvs, const LayoutOptions& options, ChartSet& charts,
                              const Context& context);

}  // namespace atlas
