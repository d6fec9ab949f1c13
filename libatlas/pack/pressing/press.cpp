#include "libatlas/pack/pressing/press.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libatlas/core/clock.h"
#include "libatlas/core/parallel.h"
#include "libatlas/pack/pressing/press_starts.h"
#include "libatlas/pack/pressing/settle.h"
#include "libatlas/pack/pressing/specks.h"

namespace atlas::pack {
namespace {

// A page that is filled less than this gets a second draw of random starts; of the pages that were
// measured, these were a third. The emptiest pages gain one to two percentage points, whereas more
// starts for all pages would gain a tenth of that in the same time. A page that is filled less than
// kPoorerFill gets a third draw.
constexpr double kPoorFill = 0.715, kPoorerFill = 0.70;
// Further draws raise the fill of 19 of 20 redrawn pages by at most these factors: after the first
// draw, and after the second.
constexpr double kMostRedrawn = 1.045, kMostRedrawnTwice = 1.025;
// Only few starts are worth pressing, because the layout on cells nearly determines how well its
// page can be pressed. More layouts gain more than pressing more starts in the same time.
constexpr std::size_t kRoughStarts = 4, kThoroughStarts = 2;

// Factors by which pressing and settling enlarge the charts of the largest start at most, in 19 of
// 20 draws, and by which they do after rough pressing.
constexpr double kMostByPressing = 1.045, kMostByThorough = 1.005;

struct Effort {
  double first_step, last_step;
  std::uint32_t sweeps;
};
constexpr Effort kRough{0.015, 0.006, 500}, kThorough{0.008, 0.003, 2000},
    kPolish{0.002, 0.0008, 600};

class Press {
 public:
  Press(std::span<const ChartOutline> outlines, const FitSearchOptions& options,
        const Context& context)
      : outlines_(outlines),
        options_(options),
        context_(context),
        pressed_(charts_to_press(outlines, options)),
        own_outlines_(without_specks()),
        starts_(pressed_.size() < outlines.size() ? own_outlines_ : outlines, options, context) {
    for (const ChartOutline& o : outlines) area_ += o.area;
  }

  PressedPage run() {
    PressedPage best = begun_page(options_, kStandardDraws);
    const double begun = wall_seconds();
    while (!context_.cancelled()) {
      draw(best);
      const double done = spent_share(options_, wall_seconds() - begun, best);
      // Charts that could not be settled once, thin ones that interlock everywhere, never are.
      if (alone() || best.scale == 0) break;
      if (options_.preset == PackPreset::best) {
        if (!(done < 1)) break;
        context_.report("packing", done);
      } else if (!worth_another_draw(best.draws, fill(best), options_.wanted_fill)) {
        break;
      }
    }
    return best;
  }

  // Makes a draw: random starts, of which the best are pressed and settled.
  // Gives up once a page of the scale `least` is out of reach.
  void draw(PressedPage& best, double least = 0) {
    std::vector<PressStart> starts = starts_.make(best.draws++, least / kMostByPressing);
    for (const PressStart& s : starts) {
      best.layouts += s.layouts;
      best.work += s.work;
    }
    if (!alone()) {
      if (!may_reach(least / kMostByPressing, starts)) return;
      press_best(starts, kRoughStarts, kRough);
      if (!may_reach(least / kMostByThorough, starts)) return;
      press_best(starts, kThoroughStarts, kThorough);
    }
    settle_best(starts, best);
  }

 private:
  bool alone() const { return pressed_.size() <= 1; }

  // Returns whether a start's charts have at least this scale.
  bool may_reach(double least, const std::vector<PressStart>& starts) const {
    return least == 0 || std::any_of(starts.begin(), starts.end(), [&](const PressStart& s) {
             return !s.poses.empty() && starts_.scale_on_page(s.page) >= least;
           });
  }

  // Returns copies of the outlines of the charts that are pressed; nothing if all are.
  std::vector<ChartOutline> without_specks() const {
    std::vector<ChartOutline> outlines;
    if (pressed_.size() == outlines_.size()) return outlines;
    for (const std::uint32_t i : pressed_) outlines.push_back(outlines_[i]);
    return outlines;
  }

  // Pushes the charts of the starts with the smallest pages together.
  void press_best(std::vector<PressStart>& starts, std::size_t most, const Effort& effort) const {
    sort_starts(starts);
    parallel_for(
        context_, std::min(most, starts.size()), 1, [&](std::size_t begin, std::size_t end) {
          for (std::size_t k = begin; k < end; ++k)
            if (!starts[k].poses.empty() && goodness(starts[k].page, options_) > 0)
              push_together(DrawnChart::coarse, squeeze_options(starts[k].page, effort), starts[k]);
        });
  }

  // The page's longer side will be the largest allowed. One texel of it is `texel` units of the
  // bodies.
  SqueezeOptions squeeze_options(const SqueezePage& page, const Effort& effort) const {
    SqueezeOptions options;
    options.first_step = effort.first_step;
    options.last_step = effort.last_step;
    options.sweeps = effort.sweeps;
    const double texel = std::max(page.width, page.height) / options_.page_size;
    options.clearance = texel * (2 * options_.padding + 0.8 * options_.alignment);
    options.margin = texel * (options_.padding + 0.2 * options_.alignment);
    options.tolerance = texel * 0.5 * options_.alignment;
    options.square = !options_.free_aspect;
    return options;
  }

  void push_together(DrawnChart::Level level, const SqueezeOptions& options,
                     PressStart& start) const {
    std::vector<Body> bodies;
    std::vector<std::size_t> owner;
    for (std::size_t i = 0; i < pressed_.size(); ++i) {
      if (outlines_[pressed_[i]].empty()) continue;
      bodies.push_back(starts_.charts()[i].bodies[level]);
      bodies.back().at = start.poses[i].first;
      bodies.back().angle = start.poses[i].second;
      owner.push_back(i);
    }
    start.page = squeeze(bodies, start.page, options);
    for (std::size_t b = 0; b < bodies.size(); ++b)
      start.poses[owner[b]] = {bodies[b].at, bodies[b].angle};
  }

  double fill(double scale, double width, double height) const {
    if (!options_.free_aspect) width = height = std::max(width, height);
    return width > 0 ? scale * scale * area_ / (width * height) : 0;
  }
  double fill(const PressedPage& page) const {
    const double side = options_.page_size;
    return options_.free_aspect ? fill(page.scale, page.page.width, page.page.height)
                                : fill(page.scale, side, side);
  }

  void sort_starts(std::vector<PressStart>& starts) const {
    std::stable_sort(starts.begin(), starts.end(), [&](const PressStart& a, const PressStart& b) {
      return goodness(a.page, options_) > goodness(b.page, options_);
    });
  }

  // Presses the fullest start once more with finer outlines and places it exactly. The next start
  // follows if that fails, or if there are so few charts that chance decides which of two starts
  // becomes fuller.
  void settle_best(std::vector<PressStart>& starts, PressedPage& best) const {
    constexpr std::size_t kFew = 16, kMost = 6;
    // Share of the fullest start's fill; an emptier start never becomes fuller.
    constexpr double kClose = 0.99;
    sort_starts(starts);
    const double fullest = goodness(starts.front().page, options_);
    bool settled = false;
    std::size_t wanted = pressed_.size() <= kFew ? kThoroughStarts : 1;
    for (std::size_t k = 0; k < std::min(starts.size(), kMost) && wanted > 0; ++k) {
      if (context_.cancelled()) return;
      if (settled && goodness(starts[k].page, options_) < kClose * fullest) return;
      if (!settle_start(starts[k], best)) continue;
      settled = true;
      --wanted;
    }
  }

  // Exact masks extend up to a cell beyond the bodies. If charts lie in each other's notches,
  // settling may lose much of the page's fill. Then bodies with more room around them give a better
  // result.
  bool settle_start(PressStart& s, PressedPage& best) const {
    constexpr double kMostLost = 0.03;         // share of the fill
    constexpr std::array kMoreRoom{0.0, 0.8};  // in multiples of the alignment
    bool settled = false;
    for (const double more : kMoreRoom) {
      if (s.poses.empty() || goodness(s.page, options_) == 0) return settled;
      SqueezeOptions polish = squeeze_options(s.page, kPolish);
      polish.clearance += more * options_.alignment;
      const SqueezePage before = s.page;
      push_together(DrawnChart::fine, polish, s);
      const bool polished = goodness(s.page, options_) > 0;
      // Finer outlines overlap too much, so the page stays as it was.
      if (!polished) s.page = before;
      const double pressed = fill(starts_.scale(), s.page.width, s.page.height);
      const PressedPage page = settle_exactly(s);
      settled = settled || page.scale > 0;
      if (fill(page) > fill(best)) take(page, best);
      if (!polished || fill(page) > (1 - kMostLost) * pressed) break;
    }
    return settled;
  }

  static void take(const PressedPage& page, PressedPage& best) {
    best.scale = page.scale;
    best.page = page.page;
    best.places = page.places;
    best.targets = page.targets;
    best.target_scale = page.target_scale;
  }

  PressedPage settle_exactly(const PressStart& s) const {
    const double grow = options_.page_size / std::max(s.page.width, s.page.height);
    std::vector<SettleTarget> targets(outlines_.size());
    for (SettleTarget& t : targets) t.anywhere = true;
    for (std::size_t i = 0; i < pressed_.size(); ++i) {
      const Vec2d center = starts_.charts()[i].center_of_shape();
      SettleTarget& target = targets[pressed_[i]];
      target.anywhere = false;
      target.origin = {s.poses[i].first.x * grow, s.poses[i].first.y * grow};
      target.angle = s.poses[i].second;
      target.from = {-center.x / starts_.scale(), -center.y / starts_.scale()};
    }
    PressedPage page = settle({outlines_, targets, starts_.scale() * grow}, options_, context_);
    page.targets = std::move(targets);
    page.target_scale = starts_.scale() * grow;
    return page;
  }

  std::span<const ChartOutline> outlines_;
  const FitSearchOptions& options_;
  const Context& context_;
  std::vector<std::uint32_t> pressed_;  // the others are specks
  std::vector<ChartOutline> own_outlines_;
  double area_ = 0;
  PressStarts starts_;
};

}  // namespace

PressedPage begun_page(const FitSearchOptions& options, std::uint32_t draws) {
  PressedPage page;
  if (options.preset != PackPreset::best || options.tried == 0) return page;
  page.layouts = options.tried;
  page.draws = draws;
  return page;
}

double spent_share(const FitOptions& options, double seconds, const PressedPage& best) {
  if (options.effort == 0) return seconds / options.time_budget;
  // 1250 layouts of 60 triangles of one size, which all fit nearly everywhere, took 3.5 s: each
  // examines 2 million words on a page of 512 cells a side. Such a layout counts as several.
  constexpr double kWordsALayout = 500'000;
  const double work = double(best.work) / kWordsALayout;
  return std::max(double(best.layouts), work) / double(options.effort);
}

bool worth_pressing(std::span<const ChartOutline> outlines, const FitOptions& options) {
  // Share of the page at the largest scale; the page may even become smaller.
  constexpr double kSurelyFits = 0.5;
  const double page = double(options.page_size) * options.page_size;
  double area = 0;
  for (const ChartOutline& o : outlines) area += o.area;
  return options.pages == 1 && options.preset != PackPreset::fast && options.any_angle &&
         options.allow_rotation && options.page_size >= 256 && area > 0 &&
         options.max_scale * options.max_scale * area > kSurelyFits * page &&
         !charts_to_press(outlines, options).empty();
}

PressedPage press_outlines(std::span<const ChartOutline> outlines, const FitSearchOptions& options,
                           const Context& context) {
  return Press(outlines, options, context).run();
}

void draw_again(std::span<const ChartOutline> outlines, const FitSearchOptions& options,
                const Context& context, PressedPage& page) {
  double area = 0;
  for (const ChartOutline& o : outlines) area += o.area;
  const double least = options.page_size * std::sqrt(options.wanted_fill / area);
  Press(outlines, options, context).draw(page, least);
}

bool worth_another_draw(std::uint32_t draws, double fill, double wanted_fill) {
  return draws < kStandardDraws && fill < (draws > 1 ? kPoorerFill : kPoorFill) &&
         (draws > 1 ? kMostRedrawnTwice : kMostRedrawn) * fill >= wanted_fill;
}

}  // namespace atlas::pack
