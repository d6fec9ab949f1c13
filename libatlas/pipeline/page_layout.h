// From chart sizes to positions on pages: stage 4 and the first half of stage 5.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libatlas/bake/placement.h"
#include "libatlas/charts/charts.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/pack/fit.h"
#include "libatlas/pack/grouping.h"
#include "libatlas/pack/pack.h"

namespace atlas {

struct LayoutOptions {
  std::uint32_t pages = 8;         // at most, >= 1
  std::int32_t page_size = 2048;   // largest side, a power of two
  std::int32_t padding = 2;        // texels kept around each chart: gutter_pad(mip_levels) to bake
  std::int32_t alignment = 4;      // charts' boxes begin and end at multiples: 2^mip_levels to bake
  std::int32_t minimum_side = 16;  // no scale makes a side of a chart shorter, if it was longer
  bool outlines = false;           // try outlines too, and take them where they pack better
  // One page whose sides are at most page_size, as full as it can be made: for uvs without images,
  // where no texel has a size.
  bool free_aspect = false;
  bool press_pages = true;     // as in FitOptions
  double wanted_fill = 0;      // as in FitOptions
  std::uint64_t tried = 0;     // as in FitOptions
  double most_won = 1.1;       // by what packing a poor page with more work may make it fuller
  bool square = false;         // pages as wide as high; free_aspect overrides it
  bool allow_rotation = true;  // charts are turned to pack better; else they lie as their uvs do
  PackPreset preset = PackPreset::standard;
  // What to change where there is no room, in the words of whoever chose the options.
  std::string remedy = "allow more or larger pages, or less padding";
};

struct PageLayout {
  std::vector<ChartPlacement> placements;  // 1 a chart
  std::vector<Extent> pages;               // texels
  bool outlines = false;                   // outlines won
  double scale = 1;                        // applied to all densities alike
  double utilization = 0;                  // of the contents the packer saw
  double uv_utilization = 0;               // area of the charts / area of the pages
  // Of charts with small holes and narrow bays that no chart could lie in: their area with these /
  // without; 1 where outlines were not tried.
  double with_lost_room = 1;
  std::uint64_t layouts = 0;  // of outlines, tried
  double won = 0;  // by what more work made a poor page fuller; 0 where it was not packed with more
  GroupingResult grouping;
};

// The texels along a unit at which the charts would cover so many, if they left no gaps between
// them; 1 where they have no area.
double filling_density(const ChartSet& charts, double texels);

// Places every chart, `texels_per_unit` (1 a chart, > 0) dense before scaling.
// Errors: no_solution when even the smallest textures do not fit; bad_option; bad_input; cancelled.
Result<PageLayout> lay_out_pages(const ChartSet& charts, std::span<const Vec2d> texels_per_unit,
                                 const LayoutOptions& options, const Context& context);

// What lay_out_pages() places.
struct WantedCharts {
  const ChartSet& charts;
  std::span<const Vec2d> texels_per_unit;  // 1 a chart, > 0
};

// The same, once it has been found without press_pages for charts and options alike: pages are not
// searched again, only pressed.
Result<PageLayout> press_layout(const WantedCharts& wanted, const LayoutOptions& options,
                                const PageLayout& unpressed, const Context& context);

}  // namespace atlas
