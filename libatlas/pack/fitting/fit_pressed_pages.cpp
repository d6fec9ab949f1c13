#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "libatlas/pack/fitting/fit_bounds.h"
#include "libatlas/pack/fitting/fit_factors.h"
#include "libatlas/pack/fitting/fit_pages.h"
#include "libatlas/pack/fitting/fit_result.h"
#include "libatlas/pack/pressing/press.h"
#include "libatlas/pack/pressing/settle.h"

namespace atlas::pack {
namespace {

// Number of attempts, per page, to press a pair of pages again with charts exchanged. `best` tries
// more.
constexpr std::size_t kExchanges = 2, kBestExchanges = 12;
// Maximum number of charts on a page. Pages of 95 charts were filled to 0.755 both by cells and by
// pressing, pages of 48 charts to 0.718 by cells and to 0.728 by pressing.
constexpr std::size_t kMostCharts = 64;
// Maximum number of pages. Each takes about 0.4 s, which two hundred pages of a small mesh would
// not be worth.
constexpr std::size_t kMostPressedPages = 24;
// Exchanges are expected to enlarge the scale by at most this factor. If the balanced scale, times
// this factor, is below the scale of the fit, or below that at which pages are as full as the
// caller wants, the fit's pages are kept.
constexpr double kMostExchanged = 1.02;
// Minimum gain in scale, by an exchange or by all together.
constexpr double kLeastGain = 1.002;
// Minimum gain that must be expected before both pages are pressed.
constexpr double kLeastExpected = 1.005;

class PagePress {
 public:
  PagePress(std::span<const ChartOutline> outlines, const FitSearchOptions& options,
            const Context& context)
      : outlines_(outlines), options_(options), context_(context) {
    options_.pages = 1;
    options_.max_scale = std::numeric_limits<double>::max();  // a single page has no limit
    options_.preset = PackPreset::standard;
  }

  // Returns false if a page is not worth pressing, or if pressing it finds nothing. It also returns
  // false if the scale is smaller than that of the fit, or than the wanted one, by more than
  // exchanges gain.
  bool start(const FitResult& fitted) {
    groups_.resize(fitted.pages.size());
    for (std::uint32_t i = 0; i < outlines_.size(); ++i) {
      Group& group = groups_[fitted.placements[i].page];
      group.charts.push_back(i);
      group.area += outlines_[i].area;
    }
    const bool may =
        std::all_of(groups_.begin(), groups_.end(), [&](const Group& g) { return may_press(g); });
    if (!may) return false;
    for (Group& g : groups_) draw(g);
    return common_scale() > 0 &&
           !(kMostExchanged * balanced_scale() < std::max(fitted.scale, wanted_scale()));
  }

  // Exchanges charts between the tightest page and others, with at most this many attempts.
  void exchange(std::size_t attempts) {
    for (; attempts > 0 && !over(); --attempts) {
      const std::optional<Exchange> chosen = best_exchange();
      if (!chosen) return;
      const auto& [from, to, out, in, gain] = *chosen;
      tried_.insert({from, to, out, in});
      const std::optional<std::array<Group, 2>> changed = exchanged(*chosen);
      if (!changed) continue;
      groups_[from] = (*changed)[0];
      groups_[to] = (*changed)[1];
      std::erase_if(tried_, [&, a = from, b = to](const auto& t) {
        return std::get<0>(t) == a || std::get<1>(t) == a || std::get<0>(t) == b ||
               std::get<1>(t) == b;
      });
    }
  }

  // Returns the scale at which charts fill the pages as far as the caller wants.
  double wanted_scale() const {
    double area = 0;
    for (const Group& g : groups_) area += g.area;
    const double pages = double(groups_.size()) * options_.page_size * options_.page_size;
    return area > 0 ? std::sqrt(options_.wanted_fill * pages / area) : 0;
  }

  // Returns the scale at which all charts would fit if they could be distributed such that every
  // page is equally tight.
  double balanced_scale() const {
    double used = 0, area = 0;
    for (const Group& g : groups_) {
      used += g.page.scale * g.page.scale * g.area;
      area += g.area;
    }
    return area > 0 ? std::sqrt(used / area) : 0;
  }

  // Returns the number of layouts of all draws.
  std::uint64_t layouts() const {
    std::uint64_t sum = 0;
    for (const auto& [charts, page] : drawn_) sum += page.layouts;
    return sum;
  }

  // Returns the scale at which every page was seen to fit.
  double common_scale() const { return groups_[tightest()].page.scale; }

  // Places the charts of all pages at this scale. Returns false if one page does not fit.
  bool settle(double scale) {
    for (Group& g : groups_) {
      if (context_.cancelled()) return false;
      if (g.page.scale == scale) {
        g.settled = g.page;
        continue;
      }
      const std::vector<ChartOutline> own = outlines_of(g);
      g.settled = settle_at(scale, {own, g.page.targets, g.page.target_scale}, options_, context_);
      if (g.settled.scale == 0) return false;
    }
    return true;
  }

  void write(FitResult& result) const {
    result.pages.clear();
    for (std::uint32_t p = 0; p < groups_.size(); ++p) {
      const Group& g = groups_[p];
      result.pages.push_back(options_.power_of_two ? Extent{options_.page_size, options_.page_size}
                                                   : squared(g.settled.page, options_));
      for (std::size_t k = 0; k < g.charts.size(); ++k) {
        FitPlacement& out = result.placements[g.charts[k]];
        out = {};
        out.page = p;
        out.scale = g.settled.scale;
        const PressedPlace& at = g.settled.places[k];
        if (at.placed) {
          write_outline({at.box, at.angle, at.offset}, options_, out);
        } else {
          write_at_corner(outlines_[g.charts[k]], out);
        }
      }
    }
  }

 private:
  struct Group {
    std::vector<std::uint32_t> charts;  // ascending
    double area = 0;                    // in square texels at scale 1
    PressedPage page, settled;
  };
  // Chart `out` goes from page `from` to page `to`, and chart `in` goes back; kNone stands for no
  // chart.
  struct Exchange {
    std::uint32_t from, to, out, in;
    double gain;  // the factor by which the scale is expected to grow
  };
  static constexpr std::uint32_t kNone = 0xffffffffu;

  std::vector<ChartOutline> outlines_of(const Group& group) const {
    std::vector<ChartOutline> own;
    for (const std::uint32_t i : group.charts) own.push_back(outlines_[i]);
    return own;
  }

  bool may_press(const Group& group) const {
    const std::vector<ChartOutline> own = outlines_of(group);
    return own.size() <= kMostCharts && worth_pressing(own, options_) &&
           !are_slivers(own, options_);
  }

  // Presses the group's page. Exchanges ask for the same charts again and again, so what was found
  // for a set of charts is kept.
  void draw(Group& group) {
    const auto [page, is_new] = drawn_.try_emplace(group.charts);
    if (is_new && !over()) page->second = press_outlines(outlines_of(group), options_, context_);
    group.page = page->second;
  }

  bool over() const { return context_.cancelled() || wall_seconds() >= options_.deadline; }

  // Presses the page. Returns whether its scale exceeds `scale`.
  bool draw_beyond(double scale, Group& group) {
    if (!may_press(group)) return false;
    draw(group);
    return group.page.scale > scale;
  }

  std::uint32_t tightest() const {
    const auto at = std::min_element(groups_.begin(), groups_.end(),
                                     [](auto& a, auto& b) { return a.page.scale < b.page.scale; });
    return static_cast<std::uint32_t>(at - groups_.begin());
  }

  double area_of(std::uint32_t chart) const { return chart == kNone ? 0 : outlines_[chart].area; }

  // Returns the exchange after which the tighter of the two pages is expected to have the largest
  // scale, if both stay as full as they are. One of the pages is the tightest of all.
  std::optional<Exchange> best_exchange() const {
    std::optional<Exchange> best;
    const std::uint32_t from = tightest();
    const Group& tight = groups_[from];
    double most = kLeastExpected;
    for (std::uint32_t to = 0; to < groups_.size(); ++to) {
      if (to == from) continue;
      const Group& loose = groups_[to];
      std::vector<std::uint32_t> back = loose.charts;
      back.push_back(kNone);
      for (const std::uint32_t out : tight.charts) {
        for (const std::uint32_t in : back) {
          const double moved = area_of(out) - area_of(in);
          if (!(moved > 0) || !(moved < tight.area) || tried_.contains({from, to, out, in}))
            continue;
          const double gain = std::min(
              std::sqrt(tight.area / (tight.area - moved)),
              loose.page.scale / tight.page.scale * std::sqrt(loose.area / (loose.area + moved)));
          if (gain <= most) continue;
          most = gain;
          best = {from, to, out, in, gain};
        }
      }
    }
    return best;
  }

  // Returns both pages with the charts exchanged, or nothing if the scale of one of them is not
  // larger than that of the tightest page was. The looser page is drawn first: it gets more to
  // hold, and mostly decides.
  std::optional<std::array<Group, 2>> exchanged(const Exchange& e) {
    const double least = kLeastGain * groups_[e.from].page.scale;
    std::array<Group, 2> changed;
    const auto take = [&](Group& g, const Group& old, std::uint32_t lost, std::uint32_t got) {
      for (const std::uint32_t i : old.charts) {
        if (i != lost) g.charts.push_back(i);
      }
      if (got != kNone)
        g.charts.insert(std::lower_bound(g.charts.begin(), g.charts.end(), got), got);
      g.area = old.area - area_of(lost) + area_of(got);
      return draw_beyond(least, g);
    };
    if (!take(changed[1], groups_[e.to], e.in, e.out) ||
        !take(changed[0], groups_[e.from], e.out, e.in)) {
      return std::nullopt;
    }
    return changed;
  }

  std::span<const ChartOutline> outlines_;
  FitSearchOptions options_;
  const Context& context_;
  std::vector<Group> groups_;
  std::map<std::vector<std::uint32_t>, PressedPage> drawn_;  // by the charts of a page
  std::set<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>> tried_;
};

}  // namespace

std::optional<FitResult> press_pages(FitResult& fitted, const FitCharts& charts,
                                     const FitSearchOptions& options, const Context& context) {
  if (!options.press_pages || options.pages < 2 || options.pages > kMostPressedPages ||
      fitted.pages.size() < options.pages || options.free_aspect ||
      fitted.scale >= options.max_scale || options.preset == PackPreset::fast ||
      below_minimum_side(charts.items, options, fitted.scale)) {
    return std::nullopt;
  }
  PagePress press(charts.outlines, options, context);
  const bool best = options.preset == PackPreset::best;
  const bool started = press.start(fitted);
  if (started) press.exchange((best ? kBestExchanges : kExchanges) * options.pages);
  fitted.layouts += press.layouts();
  if (!started) return std::nullopt;
  double scale = std::min(press.common_scale(), options.max_scale);
  constexpr double kSmaller = 0.997;
  while (scale > kLeastGain * fitted.scale && !press.settle(scale)) {
    if (context.cancelled()) return std::nullopt;
    scale *= kSmaller;
  }
  if (!(scale > kLeastGain * fitted.scale)) return std::nullopt;
  FitResult result = fitted;
  result.scale = scale;
  ++result.packings;
  press.write(result);
  double shapes = 0;
  for (const ChartOutline& outline : charts.outlines) shapes += outline.area * scale * scale;
  result.utilization = share_of_pages(shapes, result);
  return result;
}

}  // namespace atlas::pack
