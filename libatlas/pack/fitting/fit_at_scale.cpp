#include "libatlas/pack/fitting/fit_at_scale.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "libatlas/core/portable_math.h"
#include "libatlas/core/progress.h"
#include "libatlas/pack/fitting/fit_factors.h"
#include "libatlas/pack/fitting/fit_many.h"
#include "libatlas/pack/fitting/fit_result.h"
#include "libatlas/pack/pressing/settle.h"

namespace atlas::pack {
namespace {

// The share of the page that charts and gutters may fill at most, and that they are expected to
// fill.
constexpr double kFullest = 0.9, kExpected = 0.78;
// The search ends with a page on which charts exceed the largest scale by less than this factor.
constexpr double kCloseEnough = 1.03;
// A page is made larger, by this share, than the scale on the last page asks for; by twice as much
// after each page that was too small.
constexpr double kMargin = 0.01;
constexpr int kMostPages = 4;

// Searches for the side of a page that charts fill at the largest scale.
class PageSearch {
 public:
  PageSearch(const FitCharts& charts, const FitSearchOptions& options, const Context& context)
      : charts_(charts), options_(options), context_(context), most_(options.max_scale) {
    for (std::size_t i = 0; i < charts.items.size(); ++i) {
      const FitItem& item = charts.items[i];
      const double around = 2 * most_ * (item.width + item.height);
      longest_ = std::max({longest_, most_ * item.width, most_ * item.height});
      texels_ += charts.outlines[i].area * most_ * most_ +
                 options.padding * (around + 4.0 * options.padding);
    }
  }

  // Returns whether a page of the largest side may have room to spare.
  bool may_shrink() const { return side_for(kFullest) < options_.page_size; }

  // Returns nothing if no smaller page was found.
  std::optional<FitResult> run() {
    FitSearchOptions freely = options_;
    constexpr double kUnbound = 4;  // a scale that the page does not reach
    freely.max_scale = kUnbound * most_;
    std::int32_t side = side_for(kExpected), too_small = 0;
    std::optional<FitResult> best;
    double margin = kMargin;
    for (int k = 0; k < kMostPages && side < options_.page_size; ++k) {
      freely.page_size = side;
      const Result<FitResult> fit = fit_outlines(charts_, freely, part(k));
      context_.report("packing", double(k + 1) / kMostPages);
      if (context_.cancelled()) return std::nullopt;
      const double scale = fit.ok() ? fit->scale : 0;
      if (scale < most_) {
        constexpr double kMuchLarger = 1.5;
        too_small = std::max(too_small, side);
        side = rounded(side * std::min(kMuchLarger, (1 + margin) * most_ / scale));
        margin *= 2;
        continue;
      }
      std::optional<FitResult> scaled = at_most(*fit, side);
      if (scaled && (!best || scaled->utilization > best->utilization)) best = std::move(scaled);
      if (scale < kCloseEnough * most_) break;
      const std::int32_t smaller = rounded((1 + margin) * side * most_ / scale);
      if (smaller >= side || smaller <= too_small) break;
      side = smaller;
    }
    if (!best && side < options_.page_size) best = laid_at_most(side);
    return best;
  }

 private:
  Context part(int k) const {
    return part_of_stage(context_, "packing", double(k) / kMostPages, double(k + 1) / kMostPages);
  }

  std::int32_t side_for(double fill) const {
    return rounded(std::max(std::sqrt(texels_ / fill), longest_ + 2.0 * options_.padding));
  }

  // Returns the next larger side that the options allow.
  std::int32_t rounded(double side) const {
    const double least = std::max(side, double(2 * options_.padding + options_.alignment));
    const double multiple = std::ceil(least / options_.alignment) * options_.alignment;
    return std::int32_t(std::min<double>(options_.page_size, multiple));
  }

  // Returns a layout on a page of this side at the largest scale, which is below that of `fit`.
  std::optional<FitResult> at_most(const FitResult& fit, std::int32_t side) const {
    if (charts_.items.size() < kSomeOnPage) {
      if (std::optional<FitResult> settled = settled_at_most(fit, side)) return settled;
    }
    return laid_at_most(side);
  }

  // Lays the charts out anew. This happens between the pages that report their progress.
  std::optional<FitResult> laid_at_most(std::int32_t side) const {
    FitSearchOptions on_page = options_;
    on_page.page_size = side;
    on_page.free_aspect = false;  // which may choose a smaller scale
    Context unreported = context_;
    unreported.progress = {};
    Result<FitResult> fit = fit_outlines(charts_, on_page, unreported);
    if (!fit.ok() || fit->scale < most_) return std::nullopt;
    return std::move(*fit);
  }

  // Shrinks the charts where they are, and then moves them together. Returns nothing if some have
  // to be larger than others.
  std::optional<FitResult> settled_at_most(const FitResult& fit, std::int32_t side) const {
    FitSearchOptions on_page = options_;
    on_page.page_size = side;
    if (below_minimum_side(charts_.items, on_page, most_)) return std::nullopt;
    std::vector<SettleTarget> targets;
    for (std::size_t i = 0; i < fit.placements.size(); ++i) {
      const FitPlacement& p = fit.placements[i];
      const Vec2d box = box_of(charts_.outlines[i], 0), low = low_corner_of(charts_.outlines[i]);
      const Vec2d center{low.x + box.x / 2, low.y + box.y / 2};
      const double c = p.scale * portable::cos(p.angle), s = p.scale * portable::sin(p.angle);
      const Vec2d origin{p.offset.x + c * center.x - s * center.y,
                         p.offset.y + s * center.x + c * center.y};
      targets.push_back({origin, {-center.x, -center.y}, p.angle, false});
    }
    PressedPage page = settle_at(most_, {charts_.outlines, targets, fit.scale}, on_page, context_);
    if (page.scale == 0) return std::nullopt;
    page.layouts = fit.layouts;
    return result_of(page, charts_.outlines, on_page);
  }

  const FitCharts charts_;
  const FitSearchOptions& options_;
  const Context& context_;
  const double most_;
  // At the largest scale: the texels of charts and gutters, and the longest side of a chart.
  double texels_ = 0, longest_ = 0;
};

// Searches for the fullest smaller page; with an effort several times: with one round of work,
// three, seven and so on, as many as there is effort for. With more work, other pages are tried,
// and the fullest need not be among them.
std::optional<FitResult> search_pages(const FitCharts& charts, const FitSearchOptions& options,
                                      const Context& context) {
  if (options.preset != PackPreset::best || options.effort == 0)
    return PageSearch(charts, options, context).run();
  const double round = options.first_round * round_work(charts.items.size()) / kWordsOfEffort;
  FitSearchOptions some = options;
  some.preset = PackPreset::standard;
  std::optional<FitResult> best = PageSearch(charts, some, context).run();
  some.preset = PackPreset::best;
  for (double rounds = 3; !context.cancelled() && rounds * round <= double(options.effort);
       rounds = 2 * rounds + 1) {
    some.effort = std::uint64_t(std::ceil(rounds * round));
    std::optional<FitResult> next = PageSearch(charts, some, context).run();
    if (next && (!best || next->utilization > best->utilization)) best = std::move(next);
  }
  return best;
}

}  // namespace

Result<FitResult> fit_outlines_at_most(const FitCharts& charts, const FitSearchOptions& options,
                                       const Context& context) {
  if (options.free_aspect && options.pages == 1 && charts.items.size() > 1) {
    constexpr double kSearch = 0.9;  // share of the progress
    const Context searching = part_of_stage(context, "packing", 0, kSearch);
    if (PageSearch(charts, options, searching).may_shrink()) {
      std::optional<FitResult> found = search_pages(charts, options, searching);
      if (context.cancelled()) return Status::cancelled();
      if (found) return std::move(*found);
      return fit_outlines(charts, options, part_of_stage(context, "packing", kSearch, 1));
    }
  }
  return fit_outlines(charts, options, context);
}

}  // namespace atlas::pack
