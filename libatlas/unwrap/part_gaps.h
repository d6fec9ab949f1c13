// Internal: opens gaps between the parts of a chart, like the gutters between charts, where that is
// possible.
#pragma once

#include <cstdint>
#include <numbers>
#include <span>

#include "libatlas/charts/gaps.h"
#include "libatlas/unwrap/fill_pages.h"
#include "libatlas/uvs/placement.h"

namespace atlas {

// The charts below are those of the mesh beside them. A report is empty once cancelled.

// Bilinear look-ups at two places read common texels if both coordinates differ by less than two
// texels. Parts may lie in any direction from each other, so they are kept apart by this many
// texels.
constexpr double kTexelsApart = 2 * std::numbers::sqrt2;

struct PagesOfCharts {
  MeshView mesh;
  double max_stretch = 1.25;  // largest stretch of charts
  double texels = 0;          // number of texels of all pages
};

// Opens gaps before packing, for the density that charts will likely have once the common scale is
// known. `densities` are texels per unit, one per chart; charts with 0 are left alone.
GapReport open_part_gaps(const PagesOfCharts& pages, std::span<const Vec2d> densities,
                         ChartSet& charts, const Context& context);

// Measures after packing which gaps are still too narrow, in texels.
GapReport left_part_gaps(const MeshView& mesh, const ChartSet& charts,
                         std::span<const ChartPlacement> placements, const Context& context);

// The result of fill_pages_apart(), which lays out plain uvs for a lightmap. It opens gaps between
// the parts of charts, and then calls fill_pages(). If pages become emptier than most, charts are
// smaller and so are their gaps. Both steps are then done again, and the second result is kept if
// less of the borders is too near.
struct PagesOfParts {
  PageLayout layout;
  std::size_t opened = 0;  // charts opened, in the round that opened more
  GapReport left;          // texels
};
Result<PagesOfParts> fill_pages_apart(const PlainUvs& uvs, const LayoutOptions& options,
                                      ChartSet& charts, const Context& context);

}  // namespace atlas
