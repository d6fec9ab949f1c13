// Internal: lays out plain uvs on pages of a given shape, which few large charts may leave half
// empty.
#pragma once

#include "libatlas/charts/charts.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/unwrap/page_layout.h"

namespace atlas {

struct PlainUvs {
  MeshView mesh;
  const ChartOptions& options;  // those that the charts were made with
  double density;               // texels per unit of length, the same for all charts
  bool asked = false;           // the density was asked for, so that no chart has another scale
};

// Lays out `charts` at one density. A strip that is longer than a square page makes all charts
// small, and so does a chart that is larger than each of several pages. If pages stay poorly
// filled, charts are therefore cut (cut_to_limits) to ever smaller parts of a page's side, as long
// as the area that they cover grows by more than the additional seams are worth. `charts` become
// those that are laid out. Where even these leave half of the pages empty, charts that are far
// longer than the page that the others fill get scales of their own (PageLayout::own_scales).
// Neither is done with ChartOptions::min_fill = 0 or keep_uv_charts, or if everything fits at the
// wanted density. Errors: those of lay_out_pages.
Result<PageLayout> fill_pages(const PlainUvs& uvs, const LayoutOptions& options, ChartSet& charts,
                              const Context& context);

}  // namespace atlas
