// Stage 4 and the first half of stage 5: places charts of given sizes on pages.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/pack/grouping.h"
#include "libatlas/pack/pages.h"
#include "libatlas/unwrap/like.h"
#include "libatlas/uvs/placement.h"

namespace atlas {

// Page sides are powers of two unless free_aspect, which overrides `square` too.
struct LayoutOptions : PageOptions {
  std::int32_t minimum_side = 16;  // scaling makes no side of a chart shorter, if it was longer
  // Wall time of PackPreset::best, seconds, at least 0. Infinite: a fixed effort, with which
  // results repeat exactly.
  double time_budget = std::numeric_limits<double>::infinity();
  bool outlines = false;  // also try outlines, and use them if they pack better
  // Use one page whose sides are at most page_size, and make it as full as possible. This is for
  // uvs without images, where texels have no size.
  bool free_aspect = false;
  // What to change if there is no room, in the words of whoever chose the options. It is part of
  // the error message.
  std::string remedy = "allow more or larger pages, or less padding";
};

struct PageLayout {
  std::vector<ChartPlacement> placements = {};  // one per chart
  std::vector<Extent> pages = {};               // texels
  bool outlines = false;                        // the charts were packed by outlines
  double scale = 1;                             // common to all densities
  double uv_utilization = 0;                    // area of the charts / area of the pages
  GroupingResult grouping = {};
  // Charts of plain uvs that are longer than the page that all others fill, so that they have less
  // than the common scale. Ascending.
  std::vector<std::uint32_t> own_scales = {};
  // Only beside earlier uvs (like.h): what each chart has of them; and the uvs of the charts that
  // stay, one per uv of the charts, in texels of their page, NaN for the others.
  std::vector<ChartOrigin> origins = {};
  std::vector<Vec2d> kept_texels = {};
};

// Returns the texels per unit at which the charts would cover `texels` texels if they left no gaps
// between them, or 1 if they have no area.
double filling_density(const ChartSet& charts, double texels);

// Places every chart. `texels_per_unit` are the densities before scaling, one per chart, > 0.
// Errors: no_solution if even the smallest textures do not fit; bad_option; bad_input; cancelled.
Result<PageLayout> lay_out_pages(const ChartSet& charts, std::span<const Vec2d> texels_per_unit,
                                 const LayoutOptions& options, const Context& context);

}  // namespace atlas
