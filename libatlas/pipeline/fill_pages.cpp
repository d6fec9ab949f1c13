#include "libatlas/pipeline/fill_pages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "libatlas/charts/tiles.h"
#include "libatlas/core/progress.h"

namespace atlas {
namespace {

// Of the pages, what is full enough; of one that takes the shape that suits its charts best, too.
constexpr double kFilled = 0.7, kFilledFree = 0.65;
// Such a page is packed with more work where it is poor (page_layout.cpp), which takes seconds each
// time with more charts than this.
constexpr std::size_t kMostChartsFree = 300;
// Pieces that cover less than this share of what charts did are cut no smaller: more pieces still
// would be laid out for seconds in vain, as those of a spiral whose windings lay in each other.
constexpr double kHopeless = 0.5;
// Of the side of a square page that all charts would fill without gaps: how long charts may be, in
// turn.
constexpr std::array kLongestSides{1.1, 0.9, 0.75, 0.6, 0.45};
// By how much more charts must cover for pieces to be worth it, at least, and for each square root
// of the surface's area that seams become longer by.
constexpr double kLeastGain = 0.1, kSeamPrice = 0.06;

Result<PageLayout> lay_out(const ChartSet& charts, double density, const LayoutOptions& options,
                           const Context& context) {
  const std::vector<Vec2d> densities(charts.charts.size(), Vec2d{density, density});
  return lay_out_pages(charts, densities, options, context);
}

// How well layouts fill the pages that there may be.
struct Goal {
  const LayoutOptions& options;
  double texels;  // of the charts at scale 1

  double covered(const PageLayout& layout) const {  // 1 at most
    if (options.free_aspect) return layout.uv_utilization;
    const double room = double(options.pages) * options.page_size * options.page_size;
    return texels * layout.scale * layout.scale / room;
  }
  bool reached(const PageLayout& layout) const {
    const bool dense = !options.free_aspect && layout.scale >= 1;
    const double filled = layout.with_lost_room * covered(layout);
    return dense || filled >= (options.free_aspect ? kFilledFree : kFilled);
  }
};

// `charts`, cut where that fills pages better, and their layout.
Result<PageLayout> cut_to_fill(const PlainUvs& uvs, const LayoutOptions& options, ChartSet& charts,
                               const Context& context) {
  constexpr double kParts = 1 + kLongestSides.size();
  const auto part = [&](double k) {
    return part_of_stage(context, "pack", k / kParts, (k + 1) / kParts);
  };
  Result<PageLayout> best = lay_out(charts, uvs.density, options, part(0));
  const double area = charts.distortion.uv_area, root_area = std::sqrt(charts.surface_area);
  const Goal goal{options, area * uvs.density * uvs.density};
  const bool may_cut = uvs.options.min_fill > 0 && !uvs.options.keep_uv_charts &&
                       (!options.free_aspect || charts.charts.size() <= kMostChartsFree);
  if (!may_cut || !best.ok() || goal.reached(*best)) return best;
  const ChartSet whole = charts;
  const double side = std::sqrt(area / double(options.pages));
  double seams_before = whole.seam_length;
  for (std::size_t k = 0; k < kLongestSides.size(); ++k) {
    const std::vector<double> limits(whole.charts.size(), kLongestSides[k] * side);
    ChartSet cut = whole;
    if (cut_to_limits(uvs.mesh, limits, uvs.options.max_stretch, cut) == 0) continue;
    if (cut.seam_length == seams_before) continue;  // the same cuts as before
    seams_before = cut.seam_length;
    const double seams = (cut.seam_length - charts.seam_length) / root_area;
    const double least_gain = std::max(kLeastGain, kSeamPrice * seams);
    const double wanted = (1 + least_gain) * goal.covered(*best);
    if (wanted >= 1) continue;  // more than full pages hold
    LayoutOptions further = options;
    further.wanted_fill = wanted;
    Result<PageLayout> layout = lay_out(cut, uvs.density, further, part(double(k) + 1));
    if (!layout.ok() && layout.status().code() != ErrorCode::no_solution) return layout;
    if (!layout.ok()) break;  // gutters around pieces take more than there is; more so around less
    const double covered = goal.covered(*layout);
    if (covered < kHopeless * goal.covered(*best)) break;
    if (covered < wanted) continue;
    best = std::move(layout);
    charts = std::move(cut);
    if (goal.reached(*best)) break;
  }
  return best;
}

}  // namespace

Result<PageLayout> fill_pages(const PlainUvs& uvs, const LayoutOptions& options, ChartSet& charts,
                              const Context& context) {
  // Several pages are pressed in the end only: it would take seconds for each way of cutting.
  LayoutOptions unpressed = options;
  unpressed.press_pages = false;
  constexpr double kPressing = 0.6;
  const bool press = options.press_pages && options.pages > 1;
  Result<PageLayout> layout =
      cut_to_fill(uvs, unpressed, charts, part_of_stage(context, "pack", 0, press ? kPressing : 1));
  if (layout.ok() && press && layout->pages.size() > 1) {
    const std::vector<Vec2d> densities(charts.charts.size(), Vec2d{uvs.density, uvs.density});
    layout = press_layout(charts, densities, options, *layout,
                          part_of_stage(context, "pack", kPressing, 1));
  }
  context.report("pack", 1);
  return layout;
}

}  // namespace atlas
