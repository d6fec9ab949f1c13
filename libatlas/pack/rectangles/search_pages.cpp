#include <algorithm>
#include <cmath>

#include "libatlas/core/portable_math.h"
#include "libatlas/core/random.h"
#include "libatlas/core/sort_total.h"
#include "libatlas/pack/rectangles/chains.h"
#include "libatlas/pack/rectangles/gap_fill.h"
#include "libatlas/pack/rectangles/turned_problem.h"

namespace atlas::pack {
namespace {

struct FilledPage {
  std::vector<GapPlacement> items;
  std::int64_t area = 0;
};

// One search. Its state is a distribution of the items over pages. A step empties some pages and
// fills them again from a disturbed order. It is kept if the sum of squared fills grows, because
// full pages and one that becomes empty are what saves a page. Otherwise it is kept with the
// probability of simulated annealing at a low, constant temperature.
class PageChain {
 public:
  PageChain(const Problem& problem, std::uint32_t bound, std::uint64_t seed)
      : problem_(problem),
        fill_(problem.items, problem.page, problem.allow_rotation),
        bound_(bound),
        random_(seed) {}

  void start(const std::vector<FilledPage>& pages) {
    pages_ = best_ = pages;
    best_cost_ = cost_of(pages_);
  }

  bool done() const { return best_.size() <= bound_; }
  std::pair<std::uint32_t, std::int64_t> cost() const { return best_cost_; }
  const std::vector<FilledPage>& best() const { return best_; }

  void step() {
    choose_pages();
    disturb_order();
    fresh_.clear();
    double before = 0, after = 0;
    while (!sequence_.empty() && fresh_.size() < chosen_.size()) {
      fill_.clear();
      fill_.fill(sequence_);
      fresh_.push_back({fill_.placed(), fill_.placed_area()});
      after += squared(fresh_.back());
    }
    if (!sequence_.empty()) return;
    for (std::size_t p : chosen_) before += squared(pages_[p]);
    constexpr double temperature = 0.01;  // in units of a page's squared fill
    if (after < before && random_.unit() >= portable::exp((after - before) / temperature)) return;
    replace();
    const auto now = cost_of(pages_);
    if (now < best_cost_) {
      best_cost_ = now;
      best_ = pages_;
    }
  }

  static std::pair<std::uint32_t, std::int64_t> cost_of(const std::vector<FilledPage>& pages) {
    std::int64_t least = pages.empty() ? 0 : pages[0].area;
    for (const FilledPage& p : pages) least = std::min(least, p.area);
    return {static_cast<std::uint32_t>(pages.size()), least};
  }

 private:
  double squared(const FilledPage& page) const {
    const double fill = static_cast<double>(page.area) / static_cast<double>(problem_.page.area());
    return fill * fill;
  }

  // Chooses two to four pages. In half of the steps the least filled page is among them.
  void choose_pages() {
    const auto count = static_cast<std::uint32_t>(pages_.size());
    const std::size_t wanted = std::min<std::size_t>(count, 2 + random_.below(3));
    chosen_.clear();
    if (random_.below(2)) {
      std::size_t weakest = 0;
      for (std::size_t p = 1; p < count; ++p)
        if (pages_[p].area < pages_[weakest].area) weakest = p;
      chosen_.push_back(weakest);
    }
    while (chosen_.size() < wanted) {
      const std::size_t p = random_.below(count);
      if (std::find(chosen_.begin(), chosen_.end(), p) == chosen_.end()) chosen_.push_back(p);
    }
    std::sort(chosen_.begin(), chosen_.end());
  }

  // Sorts the items of the chosen pages by the logarithm of one of four keys, plus noise. The
  // amplitude of the noise is itself random: it is mostly small, and at most 1, which is a factor
  // of e.
  void disturb_order() {
    const std::uint32_t kind = random_.below(4);
    const double u = random_.unit(), noise = u * u;
    keyed_.clear();
    for (std::size_t p : chosen_)
      for (const GapPlacement& g : pages_[p].items) {
        const Extent e = problem_.items[g.item];
        const double w = e.width, h = e.height;
        const double size = kind == 0   ? w * h
                            : kind == 1 ? h * h
                            : kind == 2 ? std::max(w, h) * std::max(w, h)
                                        : (w + h) * (w + h);
        keyed_.push_back({-portable::log(size) + noise * (2 * random_.unit() - 1), g.item});
      }
    std::sort(keyed_.begin(), keyed_.end());
    sequence_.clear();
    for (const auto& [key, item] : keyed_) sequence_.push_back(item);
  }

  void replace() {
    for (std::size_t k = 0; k < fresh_.size(); ++k) std::swap(pages_[chosen_[k]], fresh_[k]);
    for (std::size_t k = chosen_.size(); k-- > fresh_.size();)
      pages_.erase(pages_.begin() + static_cast<std::ptrdiff_t>(chosen_[k]));
  }

  const Problem& problem_;
  GapFill fill_;
  std::uint32_t bound_;
  Random random_;
  std::vector<FilledPage> pages_, best_, fresh_;
  std::pair<std::uint32_t, std::int64_t> best_cost_;
  std::vector<std::size_t> chosen_;
  std::vector<std::uint32_t> sequence_;
  std::vector<std::pair<double, std::uint32_t>> keyed_;
};

std::vector<FilledPage> fill_in_order(const Problem& problem, Order order) {
  GapFill fill(problem.items, problem.page, problem.allow_rotation);
  std::vector<std::uint32_t> sequence = sorted_items(problem.items, order);
  std::vector<FilledPage> pages;
  while (!sequence.empty()) {
    fill.clear();
    fill.fill(sequence);
    pages.push_back({fill.placed(), fill.placed_area()});
  }
  return pages;
}

// Returns the pages of a layout without unplaced items.
std::vector<FilledPage> pages_of(const Problem& problem, const Layout& layout) {
  std::vector<FilledPage> pages(layout.pages);
  for (std::uint32_t i = 0; i < layout.placements.size(); ++i) {
    const Placement& p = layout.placements[i];
    pages[p.page].items.push_back({i, p.x, p.y, p.rotated});
    pages[p.page].area += problem.items[i].area();
  }
  return pages;
}

// Replaces the start by layouts of other engines that need fewer pages. They take little time: what
// `fast` does, and maximal free rectangles of items that are turned alike, if they may be turned.
void start_with_fewer(const Problem& problem, std::vector<FilledPage>& start, PackResult& result) {
  Problem open = problem;
  open.max_pages = kNoPage;
  const auto offer = [&](const Layout& layout) {
    ++result.layouts_tried;
    if (layout.unplaced == 0 && layout.pages < start.size()) start = pages_of(problem, layout);
  };
  offer(pack_widest_first(open));
  const auto first_fit = [&](const Problem& p) {
    return pack_first_fit(p, sorted_items(p.items, Order::height), PlaceRule::bottom_left);
  };
  if (!problem.allow_rotation) return offer(first_fit(open));
  for (const Turn turn : {Turn::lying, Turn::standing, Turn::none}) {
    const TurnedProblem turned(open, turn);
    Layout layout = first_fit(turned.problem());
    turned.turn_back(layout);
    offer(layout);
  }
}

// Searches the items of the two emptiest pages as a strip, which is better at filling a single
// page, and makes one page of the two if the strip is low enough.
void join_last_pages(const Problem& problem, const SearchLimits& limits, const Context& context,
                     std::vector<FilledPage>& pages) {
  std::stable_sort(pages.begin(), pages.end(),
                   [](const FilledPage& a, const FilledPage& b) { return a.area > b.area; });
  const FilledPage &one = pages[pages.size() - 2], &other = pages.back();
  if (one.area + other.area > problem.page.area()) return;
  std::vector<std::uint32_t> ids;
  std::vector<Extent> items;
  for (const FilledPage* page : {&one, &other})
    for (const GapPlacement& g : page->items) ids.push_back(g.item);
  std::sort(ids.begin(), ids.end());
  for (const std::uint32_t id : ids) items.push_back(problem.items[id]);
  Problem strip = problem;
  strip.items = items;
  strip.page.height = 1 << 30;
  strip.max_pages = 1;
  SearchLimits enough = limits_to_join(strip, limits);
  enough.enough_height = problem.page.height;
  PackResult unused;
  const Layout layout = search_strip(strip, enough, context, unused);
  if (layout.unplaced > 0 || layout.last_used > problem.page.height) return;
  FilledPage joined;
  joined.area = one.area + other.area;
  for (std::uint32_t k = 0; k < ids.size(); ++k) {
    const Placement& p = layout.placements[k];
    joined.items.push_back({ids[k], p.x, p.y, p.rotated});
  }
  pages.pop_back();
  pages.back() = std::move(joined);
}

// Puts items of the pages beyond `allowed` onto those before, wherever there is room. The largest
// come first. They are not removed from their own pages, which are about to be dropped.
void fill_in(const Problem& problem, std::uint32_t allowed, std::vector<FilledPage>& pages) {
  std::vector<std::uint32_t> left;
  for (std::size_t p = allowed; p < pages.size(); ++p)
    for (const GapPlacement& g : pages[p].items) left.push_back(g.item);
  sort_total(left.begin(), left.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(-problem.items[a].area(), a) < std::pair(-problem.items[b].area(), b);
  });
  for (std::uint32_t p = 0; p < allowed; ++p) {
    FreeRects free(problem.page);
    for (const GapPlacement& g : pages[p].items) {
      Extent e = problem.items[g.item];
      if (g.rotated) std::swap(e.width, e.height);
      free.place({g.x, g.y, e.width, e.height});
    }
    std::erase_if(left, [&](std::uint32_t item) {
      Spot spot;
      if (!free.find(problem.items[item], problem.allow_rotation, PlaceRule::bottom_left, spot))
        return false;
      free.place(spot.rect);
      pages[p].items.push_back({item, spot.rect.x, spot.rect.y, spot.rotated});
      pages[p].area += spot.rect.area();
      return true;
    });
  }
}

// Sorts the fullest pages first. If fewer pages are allowed than needed, the emptiest are dropped,
// and those of their items that find no room on the others are unplaced.
Layout to_layout(const Problem& problem, std::vector<FilledPage> pages) {
  std::stable_sort(pages.begin(), pages.end(),
                   [](const FilledPage& a, const FilledPage& b) { return a.area > b.area; });
  Layout layout;
  layout.placements.resize(problem.items.size());
  layout.unplaced = static_cast<std::uint32_t>(problem.items.size());
  if (pages.size() > problem.max_pages) {
    fill_in(problem, problem.max_pages, pages);
    pages.resize(problem.max_pages);
  }
  layout.pages = static_cast<std::uint32_t>(pages.size());
  std::int32_t used = 0;
  for (std::uint32_t p = 0; p < pages.size(); ++p)
    for (const GapPlacement& g : pages[p].items) {
      layout.placements[g.item] = {p, g.x, g.y, g.rotated};
      --layout.unplaced;
      const Extent e = problem.items[g.item];
      used = std::max(used, g.y + (g.rotated ? e.width : e.height));
    }
  if (layout.pages > 0) layout.last_used = layout.pages == 1 ? used : pages[layout.pages - 1].area;
  return layout;
}

}  // namespace

Layout search_pages(const Problem& problem, const SearchLimits& limits, const Context& context,
                    PackResult& result) {
  std::vector<FilledPage> start;
  for (Order order : {Order::area, Order::perimeter, Order::height, Order::max_side}) {
    std::vector<FilledPage> pages = fill_in_order(problem, order);
    ++result.layouts_tried;
    if (start.empty() || PageChain::cost_of(pages) < PageChain::cost_of(start))
      start = std::move(pages);
    if (start.size() <= limits.enough_pages) break;
  }
  // The bound takes longer than a layout, so it is only computed if the area does not decide.
  const std::uint32_t by_area = area_bound(problem);
  result.page_lower_bound = start.size() > by_area ? page_bound(problem) : by_area;
  const std::uint32_t enough = std::max(result.page_lower_bound, limits.enough_pages);
  if (limits.other_starts && start.size() > enough) start_with_fewer(problem, start, result);
  std::vector<PageChain> chains;
  for (std::uint32_t c = 0; c < limits.chains; ++c) {
    chains.emplace_back(problem, enough, limits.seed * 0x10001 + c);
    chains.back().start(start);
  }
  const std::size_t best = run_chains(chains, limits, context, result);
  std::vector<FilledPage> pages = chains[best].best();
  const std::uint64_t most = std::uint64_t{problem.max_pages} + 1;
  if (limits.join_layouts > 0 && !context.cancelled() && pages.size() > enough &&
      (pages.size() == 2 || pages.size() == most))
    join_last_pages(problem, limits, context, pages);
  return to_layout(problem, std::move(pages));
}

}  // namespace atlas::pack
