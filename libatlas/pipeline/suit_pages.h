// Internal: cuts large charts of a lit scene smaller if pages would otherwise stay half empty.
#pragma once

#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/unwrap/page_layout.h"

namespace atlas {

// Charts, and the texels per unit of their textures after and before downsizing, one per chart.
struct SizedCharts {
  ChartSet charts;
  std::vector<Vec2d> densities, full_densities;
  double sizing = 1;  // factor of the densities asked for at which they are sized (sizing_factor)
};

struct SuitPagesOptions {
  MeshView mesh;
  double max_stretch = 1.25;  // of pieces
};

// A floor that is cut at half a page (longest_sides()) becomes a few charts of nearly one size.
// Only a whole number of them fits a page at the scale that is found, and nothing small is there to
// fill the rest. If boxes would fill less than three quarters of the pages, and large rectangles
// are to blame, these are cut into even pieces as small as the common scale gains by it. How much
// it gains is found from boxes alone, before a triangle is touched. Pieces keep the densities of
// their chart. Returns how many charts were cut. Errors: those of cut_to_limits(); cancelled.
Result<std::size_t> suit_pages(const SuitPagesOptions& suit, const LayoutOptions& options,
                               SizedCharts& sized, const Context& context);

}  // namespace atlas
