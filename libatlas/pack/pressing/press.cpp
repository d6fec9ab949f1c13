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

// Only few starts are worth pressing, because the layout on cells nearly determines how well its
// page can be pressed. More layouts gain more than pressing more starts in the same time.
constexpr std::size_t kRoughStarts = 4, kThoroughStarts = 2;

struct Effort {
  double first_step, last_step;
};
constexpr Effort kRough{0.015, 0.006}, kThorough{0.008, 0.003}, kPolish{0.002, 0.0008};
// The share of a round's work for pushing charts together, most of which few sets of charts need.
constexpr double kPushing = 0.6;
// The same for each start that is settled.
constexpr double kSettling = 0.15;

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
    PressedPage best;
    SearchRounds rounds(options_, pressed_.size());
    while (!over() && rounds.next()) {
      draw(rounds, best);
      context_.report("packing", 1 - 1 / (rounds.number() + 2.0));
      // Charts that could not be settled once, thin ones that interlock everywhere, never are.
      if (alone() || best.scale == 0) break;
    }
    return best;
  }

 private:
  bool alone() const { return pressed_.size() <= 1; }

  bool over() const { return context_.cancelled() || wall_seconds() >= options_.deadline; }

  // Makes random starts, of which the best are pressed and settled.
  void draw(const SearchRounds& round, PressedPage& best) {
    std::vector<PressStart> starts = starts_.make(round.number(), round.share());
    const std::size_t pushed = layouts_of_round(kRoughStarts, round.share()) +
                               2 * layouts_of_round(kThoroughStarts, round.share());
    settle_work_ = kSettling * round.share() * round_work(pressed_.size());
    push_work_ = kPushing * round.share() * round_work(pressed_.size()) / double(pushed);
    for (const PressStart& s : starts) best.layouts += s.layouts;
    if (!alone()) {
      press_best(starts, layouts_of_round(kRoughStarts, round.share()), kRough);
      press_best(starts, layouts_of_round(kThoroughStarts, round.share()), kThorough);
    }
    settle_best(starts, round.share(), best);
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
    options.work = push_work_;
    const double texel = std::max(page.width, page.height) / options_.page_size;
    options.clearance = texel * (2 * options_.padding + 0.8 * options_.alignment);
    options.margin = texel * (options_.padding + 0.2 * options_.alignment);
    options.tolerance = texel * 0.5 * options_.alignment;
    options.square = !options_.free_aspect;
    options.deadline = options_.deadline;
    options.context = &context_;
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
  void settle_best(std::vector<PressStart>& starts, double share, PressedPage& best) const {
    constexpr std::size_t kFew = 16, kMost = 6;
    // Share of the fullest start's fill; an emptier start never becomes fuller.
    constexpr double kClose = 0.99;
    sort_starts(starts);
    const double fullest = goodness(starts.front().page, options_);
    bool settled = false;
    std::size_t wanted = pressed_.size() <= kFew ? layouts_of_round(kThoroughStarts, share) : 1;
    for (std::size_t k = 0; k < std::min(starts.size(), kMost) && wanted > 0; ++k) {
      if (over()) return;
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
    PressedPage page =
        settle({outlines_, targets, starts_.scale() * grow, settle_work_}, options_, context_);
    page.targets = std::move(targets);
    page.target_scale = starts_.scale() * grow;
    return page;
  }

  std::span<const ChartOutline> outlines_;
  const FitSearchOptions& options_;
  const Context& context_;
  std::vector<std::uint32_t> pressed_;  // the others are specks
  std::vector<ChartOutline> own_outlines_;
  double area_ = 0, push_work_ = 0, settle_work_ = 0;
  PressStarts starts_;
};

}  // namespace

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

}  // namespace atlas::pack
