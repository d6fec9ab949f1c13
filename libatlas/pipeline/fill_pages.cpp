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

// Of the pages, what is full enough: of a square one, of several, and of one that takes the shape
// that suits its charts best. Less than the last is poor.
constexpr double kFilled = 0.7, kFilledSeveral = 0.68, kFilledFree = 0.65;
// The latter is packed with more work where it is poor (page_layout.cpp), which takes seconds each
// time with more charts than this.
constexpr std::size_t kMostChartsFree = 300;
// Pieces that cover less than this share of what charts did are cut no smaller: more pieces still
// would be laid out for seconds in vain, as those of a spiral whose windings lay in each other.
constexpr double kHopeless = 0.5;
// Of the side of a square page that all charts would fill without gaps: how long charts may be, in
// turn.
constexpr std::array kLongestSides{1.1, 0.9, 0.75, 0.6, 0.45};
// By how much more charts must cover for pieces to be worth it, at least, and for each square root
// of the surface's area that seams become longer by; half of that where pages are poor no more.
constexpr double kLeastGain = 0.1, kLeastGainSeveral = 0.05, kSeamPrice = 0.06, kOfPoor = 0.5;
// By what pressing seldom lets charts on several pages cover more, and how many ways of cutting are
// pressed in vain. With more charts a page it takes seconds each: then pages need only not be poor.
constexpr double kMostPressed = 1.15;
constexpr int kMostVain = 2;
constexpr std::size_t kFewAPage = 16;

// How well layouts fill the pages that there may be.
struct Goal {
  const LayoutOptions& options;
  double texels;  // of the charts at scale 1

  double covered(const PageLayout& layout) const {  // 1 at most
    if (options.free_aspect) return layout.uv_utilization;
    const double room = double(options.pages) * options.page_size * options.page_size;
    return texels * layout.scale * layout.scale / room;
  }
  bool several() const { return options.pages > 1; }
  double enough(std::size_t charts) const {
    if (options.free_aspect || (several() && charts > kFewAPage * options.pages))
      return kFilledFree;
    return several() ? kFilledSeveral : kFilled;
  }
  bool reached(const PageLayout& layout) const {
    const bool dense = !options.free_aspect && layout.scale >= 1;
    return dense || layout.with_lost_room * covered(layout) >= enough(layout.placements.size());
  }
  // What pieces must cover, with seams so much longer.
  double wanted(const PageLayout& before, double seams) const {
    const double gain = std::max(several() ? kLeastGainSeveral : kLeastGain, kSeamPrice * seams);
    const double now = covered(before), worth = (1 + gain) * now;
    const double poor = kFilledFree / before.with_lost_room;
    return now < poor && worth < 1 ? std::min(worth, std::max((1 + kOfPoor * gain) * now, poor))
                                   : worth;
  }
};

// A way of cutting charts, none at first, and their layout.
struct Way {
  ChartSet charts;
  PageLayout layout;
  bool pressed = false;
};

class PageFiller {
 public:
  PageFiller(const PlainUvs& uvs, const LayoutOptions& options, const ChartSet& charts,
             const Context& context)
      : uvs_(uvs),
        options_(options),
        unpressed_(options),
        context_(context),
        goal_{options_, charts.distortion.uv_area * uvs.density * uvs.density} {
    // Several pages are pressed where it may decide, and in the end: it takes a second or more a
    // way.
    unpressed_.press_pages = false;
  }

  // Replaces the charts by those laid out.
  Result<PageLayout> run(ChartSet& charts) {
    Result<PageLayout> first = lay_out(charts, unpressed_);
    if (!first.ok()) return first;
    Way best{charts, std::move(*first)};
    if (may_cut(charts) && !goal_.reached(best.layout)) {
      if (Status s = press(best, kFilledFree); !s.ok()) return s;
      if (!goal_.reached(best.layout)) {
        if (Status s = cut(charts, best); !s.ok()) return s;
      }
    }
    if (Status s = press(best, 0); !s.ok()) return s;
    charts = std::move(best.charts);
    return std::move(best.layout);
  }

 private:
  static constexpr double kParts = 1 + kLongestSides.size();

  // What is laid out next is one part of the stage.
  Context part(double from, double to) const {
    return part_of_stage(context_, "pack", (parts_ + from) / kParts, (parts_ + to) / kParts);
  }

  std::vector<Vec2d> densities(const ChartSet& charts) const {
    return std::vector<Vec2d>(charts.charts.size(), Vec2d{uvs_.density, uvs_.density});
  }

  Result<PageLayout> lay_out(const ChartSet& charts, const LayoutOptions& options) const {
    return lay_out_pages(charts, densities(charts), options,
                         part(0, goal_.several() ? kLaidOut : 1));
  }

  // Presses pages, if they may then cover so much.
  Status press(Way& way, double wanted) const {
    if (way.pressed || !options_.press_pages || way.layout.pages.size() < 2 ||
        kMostPressed * goal_.covered(way.layout) < wanted) {
      return {};
    }
    const std::vector<Vec2d> wanted_densities = densities(way.charts);
    Result<PageLayout> pressed =
        press_layout({way.charts, wanted_densities}, options_, way.layout, part(kLaidOut, 1));
    if (!pressed.ok()) return pressed.status();
    way.layout = std::move(*pressed);
    way.pressed = true;
    return {};
  }

  bool may_cut(const ChartSet& charts) const {
    return uvs_.options.min_fill > 0 && !uvs_.options.keep_uv_charts &&
           (!options_.free_aspect || charts.charts.size() <= kMostChartsFree);
  }

  // By what more work may fill the page of pieces, by what it did to that of charts. Of 60
  // triangles of one size it won a hundredth in 3.5 s, and as much once more for each way of
  // cutting.
  double most_won_by_pieces(const PageLayout& whole) const {
    constexpr double kOnceMore = 2, kLeast = 1.01;
    if (whole.won == 0) return unpressed_.most_won;
    return std::clamp(1 + kOnceMore * (whole.won - 1), kLeast, unpressed_.most_won);
  }

  // Ever shorter, until pages are full enough. `best` becomes a way that is worth its seams.
  Status cut(const ChartSet& whole, Way& best) {
    const double area = whole.distortion.uv_area, root_area = std::sqrt(whole.surface_area);
    const double side = std::sqrt(area / double(options_.pages));
    double seams_before = whole.seam_length;
    const double most_won = most_won_by_pieces(best.layout);
    int vain = 0;
    for (const double longest : kLongestSides) {
      ++parts_;
      const std::vector<double> limits(whole.charts.size(), longest * side);
      Way way{whole, {}};
      const Result<std::size_t> pieces =
          cut_to_limits(uvs_.mesh, {limits, uvs_.options.max_stretch}, way.charts, context_);
      if (!pieces.ok()) return pieces.status();
      if (*pieces == 0) continue;
      if (way.charts.seam_length == seams_before) continue;  // the same cuts as before
      seams_before = way.charts.seam_length;
      const double seams = (way.charts.seam_length - best.charts.seam_length) / root_area;
      const double wanted = goal_.wanted(best.layout, seams);
      if (wanted >= 1) continue;  // more than full pages hold
      LayoutOptions further = unpressed_;
      further.wanted_fill = wanted;
      further.most_won = most_won;
      Result<PageLayout> layout = lay_out(way.charts, further);
      if (!layout.ok() && layout.status().code() != ErrorCode::no_solution) return layout.status();
      // Gutters around pieces take more than there is; more so around less.
      if (!layout.ok()) return {};
      way.layout = std::move(*layout);
      if (goal_.covered(way.layout) < kHopeless * goal_.covered(best.layout)) return {};
      if (vain < kMostVain) {
        if (Status s = press(way, std::max(wanted, kFilledFree)); !s.ok()) return s;
      }
      if (goal_.covered(way.layout) < wanted) {
        vain += way.pressed;
        continue;
      }
      best = std::move(way);
      if (goal_.reached(best.layout)) return {};
    }
    return {};
  }

  static constexpr double kLaidOut = 0.4;  // of a part; the rest presses several pages

  const PlainUvs& uvs_;
  const LayoutOptions& options_;
  LayoutOptions unpressed_;
  const Context& context_;
  Goal goal_;
  int parts_ = 0;  // done
};

}  // namespace

Result<PageLayout> fill_pages(const PlainUvs& uvs, const LayoutOptions& options, ChartSet& charts,
                              const Context& context) {
  Result<PageLayout> layout = PageFiller(uvs, options, charts, context).run(charts);
  context.report("pack", 1);
  return layout;
}

}  // namespace atlas
