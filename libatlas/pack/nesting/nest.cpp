#include "libatlas/pack/nesting/nest.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>

#include "libatlas/core/clock.h"
#include "libatlas/core/portable_math.h"

namespace atlas::pack {

bool searches_skip_rows(std::size_t pieces) {
  constexpr std::size_t kMany = 500;
  return pieces >= kMany;
}

namespace {

// Returns the size of a piece in the first direction in which it has a mask. If sizes are compared
// by boxes, the number of cells still counts with a weight of a quarter.
double size_of(const Piece& piece, LargestBy by) {
  const auto drawn = std::find_if(piece.masks.begin(), piece.masks.end(),
                                  [](const Mask& m) { return m.cells > 0; });
  if (drawn == piece.masks.end()) return 0;
  const double cells = double(drawn->cells), box = double(drawn->width) * drawn->height;
  return by == LargestBy::cells ? cells : box * std::sqrt(std::sqrt(cells / box));
}

}  // namespace

NestPlan plan_by_size(std::span<const Piece> pieces, LargestBy by) {
  NestPlan plan;
  plan.order.resize(pieces.size());
  std::iota(plan.order.begin(), plan.order.end(), 0u);
  std::vector<double> sizes;
  sizes.reserve(pieces.size());
  for (const Piece& p : pieces) sizes.push_back(size_of(p, by));
  std::stable_sort(plan.order.begin(), plan.order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return sizes[a] > sizes[b]; });
  plan.direction.assign(pieces.size(), kFree);
  return plan;
}

std::vector<std::uint32_t> deal_out(std::span<const Piece> pieces,
                                    std::span<const std::uint32_t> order, std::uint32_t pages) {
  using Load = std::pair<std::int64_t, std::uint32_t>;  // in cells, of a page
  std::priority_queue<Load, std::vector<Load>, std::greater<>> loads;
  for (std::uint32_t p = 0; p < pages; ++p) loads.emplace(0, p);
  std::vector<std::uint32_t> page_of(pieces.size());
  for (const std::uint32_t i : order) {
    const auto [load, page] = loads.top();
    loads.pop();
    page_of[i] = page;
    loads.emplace(load + pieces[i].cells(), page);
  }
  return page_of;
}

namespace {

// The rows in which pieces of about the same size were last placed. Pieces come largest first.
// Below the last place of a size class, the search has already failed for this size, or nearly so.
// So the search for the next piece begins there, and a page with n pieces is not scanned n times
// from the bottom. A class covers a quarter of an octave in width and in height. Each class begins
// at the bottom and fills holes of its own.
class LastPlaces {
 public:
  explicit LastPlaces(std::size_t pieces) : on_(used(pieces)) {}

  static bool used(std::size_t pieces) { return searches_skip_rows(pieces); }

  std::int32_t lowest(const Mask& mask) {
    return on_ ? row_[static_cast<std::size_t>(class_of(mask))] : 0;
  }
  // Records that no place for this size is free below `y`. If there was no place at all, `y` is
  // beyond the page.
  void searched(const Mask& mask, std::int32_t y) {
    if (!on_) return;
    std::int32_t& row = row_[static_cast<std::size_t>(class_of(mask))];
    row = std::max(row, y);
  }

 private:
  static constexpr int kSteps = 64;  // a quarter of an octave each, up to 2^16 cells

  static int step(std::int32_t cells) {
    return std::min(kSteps - 1, static_cast<int>(4 * portable::log2(double(std::max(1, cells)))));
  }
  static int class_of(const Mask& mask) { return kSteps * step(mask.width) + step(mask.height); }

  bool on_;
  std::vector<std::int32_t> row_ = std::vector<std::int32_t>(on_ ? kSteps * kSteps : 0);
};

// Finds the best direction and place of a piece on the page. It visits heights from the lowest up,
// and at each height the directions whose feet may stand there. Each direction waits in the queue
// at the next height that concerns it, so nearly all heights are passed without examining it.
class PlaceSearch {
 public:
  PlaceSearch(const Piece& piece, std::int32_t only, BitPage& page, LastPlaces& last)
      : piece_(piece), page_(page), last_(last) {
    for (std::uint32_t k : piece.by_fraction) {
      const Mask& mask = piece.masks[k];
      if (only != kFree && k != static_cast<std::uint32_t>(only)) continue;
      if (mask.cells == 0 || mask.width > page.width()) continue;
      const auto lift = static_cast<std::int32_t>(std::floor(piece.lifts[k]));
      const std::int32_t foot = last.lowest(mask);
      if (foot > page.height() - mask.height) continue;
      if (piece.tests.empty()) tests_.push_back(test_order(mask));
      feet_[count_++] = {k, lift, foot, page.height() - mask.height, 0, 0, {}};
    }
  }

  bool run(NestPlace& place) {
    std::int32_t height = std::numeric_limits<std::int32_t>::max();
    for (const Foot& f : std::span(feet_).first(count_)) height = std::min(height, f.height());
    for (std::size_t k = 0; k < count_; ++k) wait(k, height);
    std::size_t searching = count_;
    for (; searching > 0 && !place.placed; ++height) {
      std::uint64_t& here = queue_[static_cast<std::size_t>(height) % kQueue];
      for (; here != 0 && !place.placed; here &= here - 1) {
        const auto k = static_cast<std::size_t>(std::countr_zero(here));
        if (feet_[k].height() == height && visit(k, place)) found_ = k;
        if (feet_[k].row > feet_[k].last)
          --searching;
        else
          wait(k, height);
      }
    }
    note_searched(height - 1, place.placed);
    return place.placed;
  }

 private:
  static constexpr std::int32_t kNowhere = std::numeric_limits<std::int32_t>::max();
  static constexpr std::size_t kMostDirections = 64;
  static constexpr std::int32_t kQueue = 128;  // number of heights

  struct Foot {
    std::uint32_t direction;
    std::int32_t lift;       // in whole cells
    std::int32_t row, last;  // the next row to stand on, and the last possible row
    std::uint64_t likely;    // bit k: row + k; `known` bits are valid
    std::int32_t known;
    RecentProbes recent;

    std::int32_t height() const { return row + lift; }
  };

  // A direction whose next height is beyond the queue waits in steps.
  void wait(std::size_t k, std::int32_t height) {
    const std::int32_t next = std::min(feet_[k].height(), height + kQueue - 1);
    queue_[static_cast<std::size_t>(next) % kQueue] |= std::uint64_t{1} << k;
  }

  // Returns whether the foot may stand on its row. If not, it is moved to the next row that has to
  // be examined.
  bool visit(std::size_t k, NestPlace& place) {
    Foot& f = feet_[k];
    const MaskTests& tests = tests_.empty() ? piece_.tests[f.direction] : tests_[k];
    if (f.known == 0) {
      f.likely = page_.likely_feet(tests, f.row);
      f.known = 64;
    }
    if ((f.likely & 1) != 0) {
      if (page_.find_in_row(tests, {0, page_.width() - tests.width, f.row}, f.recent, place.at)) {
        place.placed = true;
        place.direction = f.direction;
        return true;
      }
      f.likely &= ~std::uint64_t{1};
    }
    const std::int32_t skip = std::min(f.known, std::countr_zero(f.likely));
    f.likely = skip < 64 ? f.likely >> skip : 0;
    f.known -= skip;
    f.row += skip;
    return false;
  }

  // Records that the rows of every direction up to this height have been searched. At the height
  // itself, only the directions before the one that was found have been searched.
  void note_searched(std::int32_t height, bool placed) {
    for (std::size_t k = 0; k < count_; ++k) {
      const Foot& f = feet_[k];
      const std::int32_t next = std::min(height - f.lift + (k < found_), f.last + 1);
      last_.searched(piece_.masks[f.direction], placed ? next : kNowhere);
    }
  }

  const Piece& piece_;
  BitPage& page_;
  LastPlaces& last_;
  std::vector<MaskTests> tests_;  // one per foot, if the piece has none
  std::array<Foot, kMostDirections> feet_;
  std::size_t count_ = 0, found_ = 0;
  std::array<std::uint64_t, kQueue> queue_{};  // bit k: foot k waits for this height
};

// Places the pieces of a plan one after another.
class Placer {
 public:
  Placer(std::span<const Piece> pieces, const NestPlan& plan, BitPage& page, Nest& nest)
      : pieces_(pieces), plan_(plan), page_(page), nest_(nest), last_(plan.order.size()) {
    nest.places.resize(pieces.size());
  }

  // Searches for the piece's place. Returns false if there is none, or if the piece has no cells.
  bool find(std::uint32_t id) {
    const Piece& piece = pieces_[id];
    if (piece.too_large) nest_.left_over.push_back(id);
    if (piece.cells() == 0) return false;
    NestPlace& place = nest_.places[id];
    const std::int32_t only = plan_.direction[id];
    if (PlaceSearch(piece, only, page_, last_).run(place)) return true;
    if (only != kFree && PlaceSearch(piece, kFree, page_, last_).run(place)) return true;
    nest_.left_over.push_back(id);
    return false;
  }

  // Puts the piece on the page. Returns false if the page has become too high.
  bool put(std::uint32_t id) {
    const NestPlace& place = nest_.places[id];
    page_.put(pieces_[id].masks[place.direction], place.at);
    if (page_.used_height() > plan_.most_height) {
      nest_.left_over.push_back(id);
      return false;
    }
    count(id);
    return true;
  }

  void count(std::uint32_t id) {
    const NestPlace& place = nest_.places[id];
    const Piece& piece = pieces_[id];
    nest_.potential +=
        static_cast<double>(piece.cells()) * (place.at.y + piece.centers[place.direction]);
  }

 private:
  std::span<const Piece> pieces_;
  const NestPlan& plan_;
  BitPage& page_;
  Nest& nest_;
  LastPlaces last_;
};

}  // namespace

void place_pieces(std::span<const Piece> pieces, const NestPlan& plan, BitPage& page, Nest& nest) {
  Placer placer(pieces, plan, page, nest);
  for (const std::uint32_t id : plan.order) {
    if (plan.context && (plan.context->cancelled() || wall_seconds() >= plan.deadline)) break;
    if (placer.find(id) && !placer.put(id)) break;
    if (plan.all_or_none && !nest.left_over.empty()) break;
  }
  nest.used_height = page.used_height();
}

void place_pieces_as(std::span<const Piece> pieces, const PlacedPlan& like, BitPage& page,
                     PlacedPlan& placed) {
  const NestPlan& plan = placed.plan;
  Nest& nest = placed.nest;
  const std::size_t n = plan.order.size();
  const auto same = [&](std::size_t k) {
    const std::uint32_t id = plan.order[k];
    return id == like.plan.order[k] && plan.direction[id] == like.plan.direction[id];
  };
  page.clear();
  nest = {};
  placed.work.assign(n, 0);
  // If searches begin at the last place of a size, the result depends on earlier searches, so
  // places cannot be copied.
  const bool known = like.work.size() == n && like.nest.left_over.empty() &&
                     like.nest.used_height <= plan.most_height && !LastPlaces::used(n);
  std::size_t begin = 0, end = n;
  while (known && begin < n && same(begin)) ++begin;
  if (begin == n) begin = 0, end = 0;
  while (known && end > begin && same(end - 1)) --end;
  Placer placer(pieces, plan, page, nest);
  bool moved = !known;  // whether a piece lies elsewhere than in `like`
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint32_t id = plan.order[k];
    if (k < begin || (k >= end && !moved)) {
      nest.places[id] = like.nest.places[id];
      placed.work[k] = like.work[k];
      if (!nest.places[id].placed) continue;
      if (k >= end)
        placer.count(id);  // no more places are searched for
      else if (!placer.put(id))
        break;
      continue;
    }
    const std::uint64_t before = page.work();
    const bool low_enough = !placer.find(id) || placer.put(id);
    placed.work[k] = page.work() - before;
    if (!low_enough) break;
    moved = moved || nest.places[id] != like.nest.places[id];
  }
  nest.used_height = moved ? page.used_height() : like.nest.used_height;
}

}  // namespace atlas::pack
