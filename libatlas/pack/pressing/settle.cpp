#include "libatlas/pack/pressing/settle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "libatlas/core/parallel.h"
#include "libatlas/core/portable_math.h"
#include "libatlas/pack/nesting/nudge.h"
#include "libatlas/pack/nesting/slide.h"

namespace atlas::pack {
namespace {

class Settler {
 public:
  Settler(const SettleCharts& charts, const FitOptions& options, const Context& context)
      : targets_(charts.targets),
        outlines_(charts.outlines),
        scale_(charts.scale),
        work_(charts.work),
        options_(options),
        context_(context) {
    order_.resize(targets_.size());
    std::iota(order_.begin(), order_.end(), 0u);
  }

  // Places all charts after shrinking them to this share of their size.
  bool place(double share, PressedPage& result) {
    if (!place_at(share, result)) return false;
    close_up(result);
    if (specks_.empty()) return true;
    const std::int32_t side = options_.page_size / options_.alignment;
    if (!place_in_gaps(specks_, side, result)) return false;
    measure(result);
    return true;
  }

  // Returns whether the last layout has charts that are far from their targets.
  bool displaced() const { return !displaced_.empty(); }

 private:
  static constexpr double kCloser = 0.8;
  static constexpr std::int64_t kSmallShare = 60;

  // Places the charts that have targets.
  bool place_at(double share, PressedPage& result) {
    draw(share * scale_, portable::pow(share, kCloser));
    result.scale = share * scale_;
    result.places.assign(targets_.size(), {});
    displaced_.clear();
    specks_.clear();
    sort_by_distance();
    for (const std::uint32_t i : order_)
      if (targets_[i].anywhere && masks_[i].cells > 0) specks_.push_back(i);
    const std::int32_t side = options_.page_size / options_.alignment;
    for (std::uint32_t i : order_)
      if (!targets_[i].anywhere && (masks_[i].width > side || masks_[i].height > side))
        return false;
    if (!place_together(side, result) && !place_in_turn(side, result)) return false;
    measure(result);
    return true;
  }

  // Puts every chart at its target and moves those that overlap, which lose a cell or two to
  // rounding, apart.
  bool place_together(std::int32_t side, PressedPage& result) {
    std::vector<PlacedMask> masks(masks_.size());
    Extent page;
    for (const std::uint32_t i : order_) {
      const Mask& mask = masks_[i];
      if (mask.cells == 0 || targets_[i].anywhere) continue;
      const auto x = static_cast<std::int32_t>(std::lround(wanted_[i].x));
      const auto y = static_cast<std::int32_t>(std::lround(wanted_[i].y));
      masks[i] = {&mask, {x, y}};
      page.width = std::min(side, std::max(page.width, std::max(0, x) + mask.width));
      page.height = std::min(side, std::max(page.height, std::max(0, y) + mask.height));
    }
    if (!nudge_apart(page, masks, work_)) return false;
    for (std::uint32_t i = 0; i < masks.size(); ++i)
      if (masks[i].mask) note(i, masks[i].at, result);
    return true;
  }

  // Places one chart after another near its target. The targets move together by less than charts
  // shrink, so most of the free space that results is at the page's upper and right edges. There,
  // charts can move out of the way of those placed before them.
  bool place_in_turn(std::int32_t side, PressedPage& result) {
    PlainPage page(side, side);
    for (std::uint32_t i : order_) {
      const Mask& mask = masks_[i];
      if (mask.cells == 0 || targets_[i].anywhere) continue;
      BitPage::Place at;
      if (nearest_free(i, page, at) || (make_way(i, page, result) && nearest_free(i, page, at))) {
        page.put(mask, at);
        note(i, at, result);
      } else if (is_small(i, side)) {
        displaced_.push_back(i);
      } else {
        return false;
      }
    }
    return displaced_.empty() || place_in_gaps(displaced_, side, result);
  }

  // Moves the charts of the last layout together, since targets leave slack between exact masks.
  void close_up(PressedPage& result) {
    constexpr int kSlides = 3;  // in each direction; a fourth slide gains nothing
    const std::int32_t a = options_.alignment;
    PlainPage page(options_.page_size / a, options_.page_size / a);
    std::vector<SlidingMask> masks;
    for (std::uint32_t i = 0; i < masks_.size(); ++i) {
      const PressedPlace& p = result.places[i];
      if (!p.placed) continue;
      masks.push_back({&masks_[i], {p.box.x / a, p.box.y / a}, i});
      page.put(masks_[i], masks.back().at);
    }
    for (int k = 0; k < kSlides; ++k) {
      const bool down = slide({0, -1}, page, masks), left = slide({-1, 0}, page, masks);
      if (!down && !left) break;
    }
    for (const SlidingMask& m : masks) note(m.chart, m.at, result);
    measure(result);
  }

  bool is_small(std::uint32_t i, std::int64_t side) const {
    return masks_[i].cells * kSmallShare < side * side;
  }

  // Puts small charts into any gap within the page that the others need, largest first.
  bool place_in_gaps(std::vector<std::uint32_t>& small, std::int32_t side, PressedPage& result) {
    const std::int32_t a = options_.alignment;
    std::int32_t longest = 1;
    for (const Mask& m : masks_)
      for (const Run& run : m.runs) longest = std::max(longest, run.end - run.begin);
    BitPage page(side, side, longest);
    for (std::uint32_t i : order_)
      if (const PressedPlace& p = result.places[i]; p.placed)
        page.put(masks_[i], {p.box.x / a, p.box.y / a});
    std::stable_sort(small.begin(), small.end(), [&](std::uint32_t i, std::uint32_t j) {
      return masks_[i].cells > masks_[j].cells;
    });
    for (std::uint32_t i : small) {
      measure(result);
      BitPage::Place at;
      const Mask& mask = masks_[i];
      const std::int32_t last = result.page.width / a - mask.width;
      if (!page.find(test_order(mask), {0, std::max(0, last), 0, side}, at)) return false;
      page.put(mask, at);
      note(i, at, result);
    }
    return true;
  }

  // A chart that lies tightly in the notch of a larger one may have kept the larger one from its
  // place. The notch shrinks with its chart, so a smaller scale does not help. This function
  // removes such small charts from the page. Returns whether it removed any.
  bool make_way(std::uint32_t i, PlainPage& page, PressedPage& result) {
    const std::int32_t side = page.width();
    bool any = false;
    for (std::uint32_t j : order_) {
      if (j == i) break;
      PressedPlace& there = result.places[j];
      if (!there.placed || !is_small(j, side) || masks_[j].cells > masks_[i].cells) continue;
      const BitPage::Place at{there.box.x / options_.alignment, there.box.y / options_.alignment};
      if (has_room_beside(i, j, at, page)) continue;
      page.take_away(masks_[j], at);
      there.placed = false;
      displaced_.push_back(j);
      any = true;
    }
    return any;
  }

  void measure(PressedPage& result) const {
    result.page = {};
    for (const PressedPlace& p : result.places)
      if (p.placed) {
        result.page.width = std::max(result.page.width, p.box.right());
        result.page.height = std::max(result.page.height, p.box.top());
      }
  }

  void note(std::uint32_t i, BitPage::Place at, PressedPage& result) const {
    const Mask& mask = masks_[i];
    const std::int32_t a = options_.alignment;
    PressedPlace& out = result.places[i];
    out.placed = true;
    out.angle = targets_[i].angle;
    out.box = {at.x * a, at.y * a, mask.width * a, mask.height * a};
    out.offset = {out.box.x + origins_[i].x, out.box.y + origins_[i].y};
  }

  void draw(double scale, double closer) {
    masks_.resize(targets_.size());
    origins_.resize(targets_.size());
    wanted_.resize(targets_.size());
    parallel_for(context_, targets_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const SettleTarget& t = targets_[i];
        RasterOptions raster;
        raster.factor = scale;
        raster.angle = t.angle;
        raster.padding = options_.padding;
        raster.cell = options_.alignment;
        masks_[i] = rasterize(outlines_[i], raster, origins_[i]);
        const double c = scale * portable::cos(t.angle), s = scale * portable::sin(t.angle);
        wanted_[i] = {(t.origin.x * closer + c * t.from.x - s * t.from.y - origins_[i].x) /
                          options_.alignment,
                      (t.origin.y * closer + s * t.from.x + c * t.from.y - origins_[i].y) /
                          options_.alignment};
      }
    });
  }

  // Sorts the charts by their distance from the page's lower left corner.
  void sort_by_distance() {
    const auto distance = [&](std::uint32_t i) {
      return wanted_[i].x + wanted_[i].y + 0.5 * (masks_[i].width + masks_[i].height);
    };
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return distance(a) < distance(b); });
  }

  // A place within a few cells of the wanted one. places_near() sorts them, nearest first.
  struct Nearby {
    double distance;
    BitPage::Place at;
  };
  static constexpr std::int32_t kReach = 5;
  using Neighbourhood = std::array<Nearby, (2 * kReach + 1) * (2 * kReach + 1)>;

  Neighbourhood places_near(std::uint32_t i, const PlainPage& page) const {
    Neighbourhood places;
    const auto x = static_cast<std::int32_t>(std::lround(wanted_[i].x));
    const auto y = static_cast<std::int32_t>(std::lround(wanted_[i].y));
    std::size_t count = 0;
    for (std::int32_t dy = -kReach; dy <= kReach; ++dy)
      for (std::int32_t dx = -kReach; dx <= kReach; ++dx) {
        const std::int32_t px = std::clamp(x + dx, 0, page.width() - masks_[i].width);
        const std::int32_t py = std::clamp(y + dy, 0, page.height() - masks_[i].height);
        places[count++] = {portable::hypot(px - wanted_[i].x, py - wanted_[i].y), {px, py}};
      }
    std::stable_sort(places.begin(), places.end(),
                     [](const Nearby& a, const Nearby& b) { return a.distance < b.distance; });
    return places;
  }

  bool nearest_free(std::uint32_t i, const PlainPage& page, BitPage::Place& place) const {
    for (const Nearby& n : places_near(i, page)) {
      if (!page.is_free(masks_[i], n.at)) continue;
      place = n.at;
      return true;
    }
    return false;
  }

  // Returns whether chart i has a place near the wanted one where it does not overlap chart j,
  // which lies at `at`.
  bool has_room_beside(std::uint32_t i, std::uint32_t j, BitPage::Place at,
                       const PlainPage& page) const {
    const Neighbourhood places = places_near(i, page);
    return std::any_of(places.begin(), places.end(), [&](const Nearby& n) {
      return !overlap(masks_[i], masks_[j], at.x - n.at.x, at.y - n.at.y);
    });
  }

  std::span<const SettleTarget> targets_;
  std::span<const ChartOutline> outlines_;
  double scale_, work_;
  const FitOptions& options_;
  const Context& context_;
  std::vector<std::uint32_t> order_, displaced_, specks_;
  std::vector<Mask> masks_;
  std::vector<Vec2d> origins_, wanted_;
};

}  // namespace

PressedPage settle(const SettleCharts& charts, const FitOptions& options, const Context& context) {
  Settler settler(charts, options, context);
  PressedPage best, tried;
  // The bodies' outlines are exact to half a cell, so the full scale hardly ever fits. Shares
  // between it and the first one are not tried, because a tenth of a percent of the scale is not
  // worth it.
  constexpr std::array kShares{0.998, 0.99, 0.98, 0.96, 0.93, 0.89};
  const auto fill = [&](const PressedPage& p) {
    const double side = std::max(p.page.width, p.page.height);
    return p.scale * p.scale / (options.free_aspect ? double(p.page.area()) : side * side);
  };
  double low = 0, high = 1;
  for (double share : kShares) {
    if (context.cancelled()) return {};
    const bool ok = settler.place(share, tried);
    if (ok && (best.scale == 0 || fill(tried) > fill(best))) best = tried;
    if (ok && !settler.displaced()) {
      low = share;
      break;
    }
    high = share;
  }
  if (low > 0 && high > low) {
    const double middle = (low + high) / 2;
    const bool ok = settler.place(middle, tried);
    if (ok && fill(tried) > fill(best)) best = tried;
  }
  return best;
}

PressedPage settle_at(double scale, const SettleCharts& charts, const FitOptions& options,
                      const Context& context) {
  Settler settler(charts, options, context);
  PressedPage page;
  if (!settler.place(scale / charts.scale, page)) return {};
  page.scale = scale;
  return page;
}

}  // namespace atlas::pack
