// Internal: gaps between the parts of a chart, as gutters between charts, where they can be had.
#pragma once

#include <cstdint>
#include <numbers>
#include <span>

#include "libatlas/bake/placement.h"
#include "libatlas/charts/gaps.h"
#include "libatlas/pipeline/fill_pages.h"
#include "libatlas/texture/chart_textures.h"

namespace atlas {

// Bilinear look-ups from two places read the same texels where both coordinates differ by less than
// two; parts lie in any direction from each other.
constexpr double kTexelsApart = 2 * std::numbers::sqrt2;

struct PagesOfCharts {
  MeshView mesh;
  double max_stretch = 1.25;  // of charts
  double texels = 0;          // of all pages
  std::int32_t max_side = 0;  // of a chart, texels; only for textures
};

// Before packing: with the density that charts will likely have once the common scale is known.
// `densities`: texels a unit, 1 a chart; 0: of no interest.
GapReport open_part_gaps(const PagesOfCharts& pages, std::span<const Vec2d> densities,
                         ChartSet& charts, const Context& context);

// The same for charts with light: those of one colour have none to mix. What thereby grows longer
// than a page gives way in density.
GapReport open_part_gaps(const PagesOfCharts& pages, std::span<ChartTexture> textures,
                         ChartSet& charts, const Context& context);

// After it: what is left, in texels.
GapReport left_part_gaps(const MeshView& mesh, const ChartSet& charts,
                         std::span<const ChartPlacement> placements, const Context& context);

// Plain uvs for a lightmap: as fill_pages(), the parts of charts drawn apart before it. Where pages
// come out emptier than most, so that charts are smaller and their gaps too, both are done again.
struct PagesOfParts {
  PageLayout layout;
  std::size_t opened = 0;  // charts, of the round that opened more
  GapReport left;          // texels
};
Result<PagesOfParts> fill_pages_apart(const PlainUvs& uvs, const LayoutOptions& options,
                                      ChartSet& charts, const Context& context);

}  // namespace atlas
