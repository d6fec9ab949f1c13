#include "libatlas/unwrap/fill_pages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "libatlas/charts/tiles.h"
#include "libatlas/core/clock.h"
#include "libatlas/core/progress.h"
#include "libatlas/pack/fitting/fit_search.h"
#include "libatlas/unwrap/layout_effort.h"
#include "libatlas/unwrap/least_room.h"
#include "libatlas/unwrap/own_scales.h"

namespace atlas {
namespace {

// The share of the pages that charts must cover for the pages to be full enough: for a square page,
// for several pages, and for one page that takes the shape that suits its charts best. Pages that
// are filled to less than the last count as poorly filled.
constexpr double kFilled = 0.7, kFilledSeveral = 0.68, kFilledFree = 0.65;
// A strip that is as long as the page of free shape keeps all charts coarse, however full that page
// is: a road of 1:200 got 11 rows of texels. So pages that are more slender than this count as if
// they had the rest of the room, too, unless charts already have the density asked for.
constexpr double kMostSlender = 12;
// A page of free shape is filled by cutting only if it has at most this many charts. With more,
// laying out takes seconds for each way of cutting.
constexpr std::size_t kMostChartsFree = 300;
// If pieces cover less than this share of what the charts covered, they are cut no smaller: even
// more pieces would be laid out for seconds in vain. This was the case for a spiral whose windings
// lay inside each other.
constexpr double kHopeless = 0.5;
// How long charts may be, in the order tried, relative to the side of a square page that all charts
// would fill without gaps.
constexpr std::array kLongestSides{1.1, 0.9, 0.75, 0.6, 0.45};
// The work of laying out the pieces of one way of cutting, as a share of that for the whole charts.
constexpr double kOfTrial = 0.125;
// With the rest of the work, pieces cover up to kMostWorked times as much.
constexpr double kMostWorked = 1.08;
// Pieces are worth it if they cover more than the charts did, by at least kLeastGain (of one page)
// or kLeastGainSeveral (of several), and by at least kSeamPrice for each square root of the
// surface's area by which seams become longer. For poorly filled pages, kOfPoor of that is enough
// if they are then no longer poorly filled.
constexpr double kLeastGain = 0.1, kLeastGainSeveral = 0.05, kSeamPrice = 0.06, kOfPoor = 0.5;
// Pressing seldom lets charts on several pages cover more than kMostPressed times as much. At most
// kMostVain ways of cutting are pressed or worked on in vain. With more than kFewAPage charts per
// page, pressing takes seconds for each way, so such pages only need kFilledFree.
constexpr double kMostPressed = 1.15;
constexpr int kMostVain = 2;
constexpr std::size_t kFewAPage = 16;
// Several pages that are filled to less are laid out once more as fewer pages. Pages that would
// otherwise be filled to less are filled to more by scales of their own for the longest charts.
constexpr double kPoor = 0.5;

// Tells how well layouts fill the pages that may be used.
struct Goal {
  const LayoutOptions& options;
  double texels;  // area of the charts at scale 1

  double covered(const PageLayout& layout) const {  // share of the pages, at most 1
    if (options.free_aspect) return slenderness(layout) * layout.uv_utilization;
    const double room = double(options.pages) * options.page_size * options.page_size;
    return texels * layout.scale * layout.scale / room;
  }
  // Returns the factor by which a page of free shape is too slender.
  double slenderness(const PageLayout& layout) const {
    if (layout.scale >= 1 || layout.pages.size() != 1) return 1;
    const auto [shorter, longer] = std::minmax(layout.pages[0].width, layout.pages[0].height);
    return longer > 0 ? std::min(1.0, kMostSlender * shorter / longer) : 1;
  }
  bool several() const { return options.pages > 1; }
  double enough(std::size_t charts) const {
    if (options.free_aspect || (several() && charts > kFewAPage * options.pages))
      return kFilledFree;
    return several() ? kFilledSeveral : kFilled;
  }
  bool reached(const WorkedLayout& layout) const {
    const bool dense = !options.free_aspect && layout.scale >= 1;
    return dense || covered(layout) >= full(layout);
  }
  // Returns the share of the pages that the charts of a layout must cover for it to be reached.
  double full(const WorkedLayout& layout) const {
    return enough(layout.placements.size()) / layout.with_lost_room;
  }
  // Returns the share of the pages that pieces must cover. `seams` is by how much seams become
  // longer, relative to the square root of the surface's area.
  double wanted(const WorkedLayout& before, double seams) const {
    const double gain = std::max(several() ? kLeastGainSeveral : kLeastGain, kSeamPrice * seams);
    const double now = covered(before), worth = (1 + gain) * now;
    const double poor = kFilledFree / before.with_lost_room;
    return now < poor && worth < 1 ? std::min(worth, std::max((1 + kOfPoor * gain) * now, poor))
                                   : worth;
  }
};

// A way of cutting charts (at first none is cut), and the layout of the pieces.
struct Way {
  ChartSet charts;
  WorkedLayout layout;
  bool pressed = false, worked = false;
  std::vector<double> own_scales = {};  // one per chart, or empty: all have the common scale
};

class PageFiller {
 public:
  PageFiller(const PlainUvs& uvs, const LayoutOptions& options, const ChartSet& charts,
             const Context& context)
      : uvs_(uvs),
        options_(effort_of(options)),
        unpressed_(options_),
        context_(context),
        goal_{options_, charts.distortion.uv_area * uvs.density * uvs.density} {
    // Several pages are pressed only if it may decide between ways, and at the end, because it
    // takes a second or more for each way.
    unpressed_.press_pages = false;
    // A limited time is spent on the way that is chosen, and not on comparing them.
    if (timed()) unpressed_.preset = PackPreset::standard;
  }

  // Replaces the charts by those that are laid out.
  Result<PageLayout> run(ChartSet& charts) {
    Way best{charts, {}};
    if (Status s = fill(charts, best); !s.ok()) return s;
    if (Status s = scale_longest(charts, best); !s.ok()) return s;
    if (Status s = press(best, options_, 0); !s.ok()) return s;
    if (timed() && !over()) {
      Result<WorkedLayout> searched = lay_out(best, options_);
      if (searched.ok() && goal_.covered(*searched) > goal_.covered(best.layout))
        best.layout = std::move(*searched);
      if (context_.cancelled()) return Status::cancelled();
    }
    charts = std::move(best.charts);
    PageLayout layout(std::move(best.layout));
    for (std::uint32_t c = 0; c < best.own_scales.size(); ++c)
      if (best.own_scales[c] < 1) layout.own_scales.push_back(c);
    return layout;
  }

 private:
  static LayoutEffort effort_of(const LayoutOptions& options) {
    LayoutEffort effort{options};
    if (options.preset == PackPreset::best) effort.deadline = wall_seconds() + options.time_budget;
    return effort;
  }
  bool timed() const { return std::isfinite(options_.deadline); }
  bool over() const { return wall_seconds() >= options_.deadline; }

  static constexpr double kParts = 1 + kLongestSides.size();

  // Lays out whole charts, and cuts them if they leave the pages too empty.
  Status fill(const ChartSet& whole, Way& best) {
    Result<WorkedLayout> first = lay_out(best, unpressed_);
    if (!first.ok()) return first.status();
    best.layout = std::move(*first);
    if (!may_cut(best.charts) || goal_.reached(best.layout)) return {};
    if (Status s = press(best, options_, kFilledFree); !s.ok()) return s;
    return goal_.reached(best.layout) ? Status() : cut(whole, best);
  }

  // Gives charts that leave pages poorly filled, and cannot be cut, scales of their own.
  Status scale_longest(const ChartSet& charts, Way& best) {
    const double enough = kPoor / best.layout.with_lost_room;
    if (uvs_.asked || !cuts() || over() || goal_.covered(best.layout) >= enough) return {};
    Way scaled{charts, {}};
    scaled.own_scales = own_scales(charts, options_.pages);
    if (scaled.own_scales.empty()) return {};
    context_.progress = nullptr;  // which must not begin anew
    const Status filled = fill(charts, scaled);
    if (context_.cancelled()) return Status::cancelled();
    if (filled.ok() && goal_.covered(scaled.layout) >= enough) best = std::move(scaled);
    return {};
  }

  // Returns the context for a section of the current part. Each way of cutting is one part of the
  // stage.
  Context part(double from, double to) const {
    return part_of_stage(context_, "packing", (parts_ + from) / kParts, (parts_ + to) / kParts);
  }

  static double scaled_area(const Way& way) {
    double area = way.charts.distortion.uv_area;
    for (std::size_t c = 0; c < way.own_scales.size(); ++c)
      area -= (1 - way.own_scales[c] * way.own_scales[c]) * way.charts.charts[c].distortion.uv_area;
    return area;
  }

  // Returns the scales of pieces, which are those of the charts that they were cut from.
  static std::vector<double> of_pieces(const std::vector<double>& scales, const ChartSet& whole,
                                       const ChartSet& pieces) {
    std::vector<double> result;
    for (const Chart& piece : pieces.charts)
      if (!scales.empty())
        result.push_back(
            scales[whole.triangle_chart[pieces.chart_triangles[piece.first_triangle]]]);
    return result;
  }

  // Returns the densities of charts, which fill the pages without gaps as those of one scale do.
  std::vector<Vec2d> densities(const Way& way) const {
    const double more = std::sqrt(way.charts.distortion.uv_area / scaled_area(way));
    const double all = way.own_scales.empty() ? uvs_.density : uvs_.density * more;
    std::vector<Vec2d> densities(way.charts.charts.size(), Vec2d{all, all});
    for (std::size_t c = 0; c < way.own_scales.size(); ++c)
      densities[c] = {all * way.own_scales[c], all * way.own_scales[c]};
    return densities;
  }

  Result<WorkedLayout> lay_out(const Way& way, const LayoutEffort& options) const {
    return lay_out_charts({way.charts, densities(way)}, options, part(0, kLaidOut));
  }

  // Lays out pieces with as much work as the whole charts, which so many are.
  Status lay_out_fully(Way& way, std::size_t whole, double wanted) const {
    LayoutEffort effort = with_work_of(whole, 1, way);
    effort.wanted_fill = wanted;
    Result<WorkedLayout> fuller = lay_out(way, effort);
    if (fuller.ok() && goal_.covered(*fuller) > goal_.covered(way.layout))
      way.layout = std::move(*fuller);
    way.worked = true;
    return context_.cancelled() ? Status::cancelled() : Status();
  }

  // Returns options for work on this share of what is spent on the whole charts.
  LayoutEffort with_work_of(std::size_t whole, double share, const Way& way) const {
    LayoutEffort effort = unpressed_;
    effort.first_round =
        share * std::min(1.0, pack::round_work(whole) / pack::round_work(way.charts.charts.size()));
    return effort;
  }

  // Presses the pages, if they may then cover the share `wanted`.
  Status press(Way& way, const LayoutEffort& options, double wanted) const {
    if (way.pressed || !options_.press_pages || way.layout.pages.size() < 2 ||
        kMostPressed * goal_.covered(way.layout) < wanted) {
      return {};
    }
    const std::vector<Vec2d> wanted_densities = densities(way);
    Result<WorkedLayout> pressed =
        press_layout({way.charts, wanted_densities}, options, way.layout, part(kLaidOut, 1));
    if (!pressed.ok()) return pressed.status();
    way.layout = std::move(*pressed);
    way.pressed = true;
    return {};
  }

  bool cuts() const { return uvs_.options.min_fill > 0 && !uvs_.options.keep_uv_charts; }
  bool may_cut(const ChartSet& charts) const {
    return cuts() && (!options_.free_aspect || charts.charts.size() <= kMostChartsFree);
  }

  // Cuts charts ever shorter until the pages are full enough. `best` becomes the last way that is
  // worth its seams.
  Status cut(const ChartSet& whole, Way& best) {
    const std::vector<double> scales = best.own_scales;
    const double root_area = std::sqrt(whole.surface_area);
    const double side = std::sqrt(scaled_area(best) / double(options_.pages));
    double seams_before = whole.seam_length;
    int vain = 0;
    for (const double longest : kLongestSides) {
      ++parts_;
      if (over()) return {};
      std::vector<double> limits(whole.charts.size(), longest * side);
      for (std::size_t c = 0; c < scales.size(); ++c)
        if (scales[c] < 1) limits[c] = std::numeric_limits<double>::infinity();
      Way way{whole, {}};
      const Result<std::size_t> pieces =
          cut_to_limits(uvs_.mesh, {limits, uvs_.options.max_stretch}, way.charts, context_);
      if (!pieces.ok()) return pieces.status();
      if (*pieces == 0) continue;
      way.own_scales = of_pieces(scales, whole, way.charts);
      if (way.charts.seam_length == seams_before) continue;  // the same cuts as before
      seams_before = way.charts.seam_length;
      const double seams = (way.charts.seam_length - best.charts.seam_length) / root_area;
      const double wanted = goal_.wanted(best.layout, seams);
      if (wanted >= 1) continue;  // more than full pages hold
      // Charts of 10^6 : 1 come in thousands of pieces, whose gutters leave less than a hundredth
      // of the page. Laying them out for each way of cutting took 17 s.
      if (most_covered(way.charts, uvs_.density, options_) < wanted) continue;
      LayoutEffort further = with_work_of(whole.charts.size(), kOfTrial, way);
      further.wanted_fill = wanted;
      Result<WorkedLayout> layout = lay_out(way, further);
      if (!layout.ok() && layout.status().code() != ErrorCode::no_solution) return layout.status();
      // The gutters around the pieces take more room than there is, and those around smaller pieces
      // would take even more.
      if (!layout.ok()) return {};
      way.layout = std::move(*layout);
      if (goal_.covered(way.layout) < kHopeless * goal_.covered(best.layout)) return {};
      if (kMostWorked * goal_.covered(way.layout) >= wanted && vain < kMostVain) {
        if (Status s = lay_out_fully(way, whole.charts.size(), wanted); !s.ok()) return s;
      }
      if (Status s = improve(way, further, vain < kMostVain); !s.ok()) return s;
      if (goal_.covered(way.layout) < wanted) {
        vain += way.pressed || way.worked;
        continue;
      }
      best = std::move(way);
      if (goal_.reached(best.layout)) return {};
    }
    return {};
  }

  // Presses several pages of pieces if that may make them as full as they are wanted.
  Status improve(Way& way, const LayoutEffort& further, bool may_press) const {
    if (!may_press) return {};
    LayoutEffort pressed = further;
    pressed.press_pages = true;
    return press(way, pressed, std::max(further.wanted_fill, kFilledFree));
  }

  // Share of a part; pressing several pages is the rest.
  static constexpr double kLaidOut = 0.4;

  const PlainUvs& uvs_;
  const LayoutEffort options_;
  LayoutEffort unpressed_;
  Context context_;
  Goal goal_;
  int parts_ = 0;  // how many are done
};

// What is laid out, before anything was cut.
struct Whole {
  const PlainUvs& uvs;
  const LayoutOptions& options;
  ChartSet& charts;
};

// What cuts cover of pages that stay empty is too little to be worth their seams, and triangles
// longer than a page are not cut at all: eight pages of a hinge had longer texels than two.
// Therefore lays poorly filled pages out again, as so few as could hold what they do. `layout` and
// `charts` become the denser result.
Status try_fewer_pages(const Whole& whole, double left, PageLayout& layout, ChartSet& charts,
                       const Context& context) {
  const std::size_t count = layout.pages.size();
  if (count == whole.options.pages && layout.uv_utilization >= kPoor) return {};
  LayoutOptions fewer = whole.options;
  fewer.time_budget = left;
  const double filled = layout.uv_utilization * double(count) / kFilledSeveral;
  fewer.pages = std::max(2u, std::uint32_t(std::ceil(filled)));
  if (fewer.pages >= whole.options.pages) return {};
  Result<PageLayout> denser = PageFiller(whole.uvs, fewer, whole.charts, context).run(whole.charts);
  if (denser.status().code() == ErrorCode::no_solution) return {};
  if (!denser.ok()) return denser.status();
  if (common_density(*denser) <= common_density(layout)) return {};
  layout = std::move(*denser);
  charts = std::move(whole.charts);
  return {};
}

}  // namespace

Result<PageLayout> fill_pages(const PlainUvs& uvs, const LayoutOptions& options, ChartSet& charts,
                              const Context& context) {
  const double begun = wall_seconds();
  const Context stage = part_of_stage(context, "packing");  // an early way may be pressed last
  const bool may_cut = options.pages > 2 && uvs.options.min_fill > 0 && !uvs.options.keep_uv_charts;
  ChartSet whole;
  if (may_cut) whole = charts;
  Result<PageLayout> layout = PageFiller(uvs, options, charts, stage).run(charts);
  if (may_cut && layout.ok() && layout->scale < 1) {
    const double left = std::max(0.0, options.time_budget - (wall_seconds() - begun));
    if (Status s = try_fewer_pages({uvs, options, whole}, left, *layout, charts, stage); !s.ok())
      return s;
  }
  stage.report("packing", 1);
  return layout;
}

}  // namespace atlas
