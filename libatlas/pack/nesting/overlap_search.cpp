#include "libatlas/pack/nesting/overlap_search.h"

#include <algorithm>
#include <array>
#include <limits>

#include "libatlas/core/clock.h"
#include "libatlas/core/random.h"
#include "libatlas/pack/nesting/pair_overlaps.h"
#include "libatlas/pack/nesting/weight_map.h"

namespace atlas::pack {
namespace {

constexpr std::int32_t kColumn = WeightMap::kColumn;
constexpr std::int32_t kLight = PairOverlaps::kLeastWeight;
constexpr std::int32_t kUnweighed = std::numeric_limits<std::int32_t>::max();
// Rounds without less overlap after which the least overlap so far is tried again with equal
// weights. With half as many rounds strips become less low; twice as many win nothing.
constexpr std::uint32_t kVainRounds = 100;
// A strip becomes lower by this share of its height at a time, and by one row at least.
constexpr std::int32_t kShrink = 200;
// The search ends when it has spent this share of its work since it last made the strip lower. 47
// meshes fill 0.7266 of their pages, with all of the work 0.7270 and with a third of it 0.7252.
constexpr double kMostVain = 0.5;
// For each move: columns of places that are drawn from the whole strip, columns drawn near the
// piece, and the number of places that are refined.
constexpr int kFarColumns = 40, kNearColumns = 15;
constexpr std::size_t kRefined = 3;
// Refining begins with steps of this many cells and makes each step this many times at most.
constexpr std::int32_t kFirstStep = 4;
constexpr int kMostSteps = 3;
// Words that weighing a place takes besides the runs of its mask. Without them, two slivers a row
// high were moved a million times for the work of a few thousand moves.
constexpr std::uint64_t kWordsAPlace = 16;

struct Candidate {
  BitPage::Place at;
  std::uint32_t direction = 0;
  std::int32_t weight = kUnweighed;
};

// The lightest candidates so far, lightest first.
class Candidates {
 public:
  std::int32_t heaviest() const { return best_.back().weight; }
  std::array<Candidate, kRefined>& all() { return best_; }
  const Candidate& lightest() const { return best_.front(); }

  void add(const Candidate& c) {
    if (c.weight >= heaviest()) return;
    best_.back() = c;
    for (std::size_t k = kRefined - 1; k > 0 && best_[k].weight < best_[k - 1].weight; --k)
      std::swap(best_[k], best_[k - 1]);
  }

 private:
  std::array<Candidate, kRefined> best_;
};

class OverlapSearch {
 public:
  OverlapSearch(std::span<const Piece> pieces, const OverlapSearchOptions& options, Nest& nest)
      : pieces_(pieces),
        options_(options),
        nest_(nest),
        places_(nest.places),
        masks_(masks_of(pieces, nest.places)),
        height_(nest.used_height),
        map_(options.width, nest.used_height),
        pairs_(masks_),
        random_(options.seed) {}

  std::uint64_t run(const Context& context) {
    const auto vain = std::uint64_t(kMostVain * double(options_.work));
    while (work_ < std::min(options_.work, lowered_ + vain) && !context.cancelled() &&
           wall_seconds() < options_.deadline) {
      if (pairs_.total() == 0) {
        if (height_ < nest_.used_height) take();
        if (height_ <= options_.low_enough || !lower()) break;
        continue;
      }
      if (pairs_.total() < least_) {
        least_ = pairs_.total();
        kept_ = places_;
        vain_ = 0;
      } else if (++vain_ > kVainRounds) {
        for (const std::uint32_t i : pairs_.taking_part()) put(i, kept_[i]);
        begin_anew();
      }
      pairs_.raise_weights();
      move_all();
    }
    return work_;
  }

 private:
  static std::vector<PlacedMask> masks_of(std::span<const Piece> pieces,
                                          std::span<const NestPlace> places) {
    std::vector<PlacedMask> masks(pieces.size());
    for (std::size_t i = 0; i < pieces.size(); ++i)
      if (places[i].placed) masks[i] = {&pieces[i].masks[places[i].direction], places[i].at};
    return masks;
  }

  void put(std::uint32_t i, const NestPlace& place) {
    places_[i] = place;
    masks_[i] = {&mask(i, place.direction), place.at};
  }

  const Mask& mask(std::uint32_t i, std::uint32_t direction) const {
    return pieces_[i].masks[direction];
  }
  const Mask& mask(std::uint32_t i) const { return *masks_[i].mask; }
  bool fits(const Mask& m) const {
    return m.cells > 0 && m.width <= options_.width && m.height <= height_;
  }

  void take() {
    nest_.places = places_;
    nest_.used_height = 0;
    for (const std::uint32_t i : pairs_.taking_part())
      nest_.used_height = std::max(nest_.used_height, places_[i].at.y + mask(i).height);
    height_ = nest_.used_height;
    lowered_ = work_;
  }

  // Makes the strip lower and pushes the pieces into it. Returns false if a piece is too large.
  bool lower() {
    height_ -= std::max(1, height_ / kShrink);
    for (const std::uint32_t i : pairs_.taking_part()) {
      NestPlace p = places_[i];
      if (!fits(mask(i))) {
        const auto& masks = pieces_[i].masks;
        const auto found =
            std::find_if(masks.begin(), masks.end(), [&](const Mask& m) { return fits(m); });
        if (found == masks.end()) return false;
        p.direction = static_cast<std::uint32_t>(found - masks.begin());
        p.at.x = std::min(p.at.x, options_.width - found->width);
      }
      p.at.y = std::min(p.at.y, height_ - mask(i, p.direction).height);
      put(i, p);
    }
    begin_anew();
    least_ = std::numeric_limits<std::int64_t>::max();
    return true;
  }

  // Measures all pairs, which get equal weights.
  void begin_anew() {
    pairs_.reset();
    map_.clear();
    for (const std::uint32_t i : pairs_.taking_part()) map_.add(mask(i), places_[i].at, kLight);
    vain_ = 0;
  }

  // Moves all pieces that overlap others, in random order.
  void move_all() {
    order_.clear();
    for (const std::uint32_t i : pairs_.taking_part())
      if (pairs_.overlaps(i)) order_.push_back(i);
    for (auto k = static_cast<std::uint32_t>(order_.size()); k > 1; --k)
      std::swap(order_[k - 1], order_[random_.below(k)]);
    for (const std::uint32_t i : order_)
      if (pairs_.overlaps(i)) move(i);
  }

  void move(std::uint32_t i) {
    map_.add(mask(i), places_[i].at, -kLight);
    add_heavy_pairs(i, 1);
    map_.sum();
    work_ += map_.words();

    Candidates best = draw(i);
    Candidate lightest = best.lightest();
    for (Candidate& c : best.all()) {
      if (lightest.weight == 0 || c.weight == kUnweighed) break;
      refine(i, c);
      if (c.weight < lightest.weight) lightest = c;
    }
    add_heavy_pairs(i, -1);
    put(i, {true, lightest.direction, lightest.at});
    map_.add(mask(i), places_[i].at, kLight);
    pairs_.measure(i);
  }

  // Adds `times` what the weights of the pairs of i exceed the least weight by.
  void add_heavy_pairs(std::uint32_t i, std::int32_t times) {
    for (const std::uint32_t j : pairs_.taking_part()) {
      if (j == i) continue;
      const std::int32_t more = pairs_.weight(i, j) - kLight;
      if (more > 0) map_.add(mask(j), places_[j].at, times * more);
      if (times > 0) work_ += mask(j).runs.size();
    }
  }

  // Weighs places everywhere and near the present one until one is free.
  Candidates draw(std::uint32_t i) {
    const auto directions = static_cast<std::uint32_t>(pieces_[i].masks.size());
    const NestPlace now = places_[i];
    Candidates best;
    best.add(weigh(i, now.direction, now.at, best.heaviest()));
    for (int k = 0; k < kFarColumns + kNearColumns && best.lightest().weight > 0; ++k) {
      const std::uint32_t d = random_.below(directions);
      const Mask& m = mask(i, d);
      if (!fits(m)) continue;
      BitPage::Place at;
      if (k < kFarColumns) {
        at = {below(options_.width - m.width + 1), below(height_ - m.height + 1)};
      } else {
        const std::int32_t reach = std::max(m.width, m.height) / 2 + 1;
        at = centred(i, d, now);
        at.x += below(reach) - reach / 2;
        at.y += below(reach) - reach / 2;
      }
      best.add(weigh(i, d, at, best.heaviest()));
    }
    return best;
  }

  std::int32_t below(std::int32_t n) {
    return static_cast<std::int32_t>(random_.below(static_cast<std::uint32_t>(n)));
  }

  // Returns the place in direction d whose box has the centre of that of `old`.
  BitPage::Place centred(std::uint32_t i, std::uint32_t d, const NestPlace& old) const {
    const Mask &from = mask(i, old.direction), &to = mask(i, d);
    return {old.at.x + (from.width - to.width) / 2, old.at.y + (from.height - to.height) / 2};
  }

  // Moves the candidate to lighter places beside it, and turns it, until there are none.
  void refine(std::uint32_t i, Candidate& c) {
    const auto directions = static_cast<std::uint32_t>(pieces_[i].masks.size());
    for (std::int32_t step = kFirstStep; step >= 1; step /= 2)
      for (int k = 0; k < kMostSteps; ++k) {
        const std::int32_t before = c.weight;
        for (const std::int32_t dx : {step, -step}) {
          consider(weigh(i, c.direction, {c.at.x + dx, c.at.y}, c.weight), c);
          if (c.weight == 0) return;
        }
        for (const std::uint32_t turn : {1u, directions - 1}) {
          const std::uint32_t d = (c.direction + turn) % directions;
          if (!fits(mask(i, d))) continue;
          consider(weigh(i, d, centred(i, d, {true, c.direction, c.at}), c.weight), c);
          if (c.weight == 0) return;
        }
        if (c.weight == before) break;
      }
  }

  static void consider(const Candidate& next, Candidate& c) {
    if (next.weight < c.weight) c = next;
  }

  // Returns the lightest place of the column around `at`, or a weight above `most`.
  Candidate weigh(std::uint32_t i, std::uint32_t d, BitPage::Place at, std::int32_t most) {
    const Mask& m = mask(i, d);
    const std::int32_t top = height_ - m.height;
    const BitPage::Place lowest{std::clamp(at.x, 0, options_.width - m.width),
                                std::clamp(at.y - kColumn / 2, 0, std::max(0, top - kColumn + 1))};
    work_ += m.runs.size() + kWordsAPlace;
    const WeightMap::Lightest found =
        map_.weigh(m, lowest, std::min(kColumn, top - lowest.y + 1), most);
    return {found.at, d, found.weight};
  }

  std::span<const Piece> pieces_;
  const OverlapSearchOptions& options_;
  Nest& nest_;  // the lowest layout without overlaps so far
  std::vector<NestPlace> places_, kept_;
  std::vector<PlacedMask> masks_;  // those of places_
  std::int32_t height_;
  WeightMap map_;  // all masks have the weight kLight, except during a move
  PairOverlaps pairs_;
  Random random_;
  std::vector<std::uint32_t> order_;
  std::int64_t least_ = 0;  // overlap of kept_
  std::uint32_t vain_ = 0;
  std::uint64_t work_ = 0, lowered_ = 0;  // by now, and when the strip last became lower
};

}  // namespace

std::uint64_t search_overlaps(std::span<const Piece> pieces, const OverlapSearchOptions& options,
                              const Context& context, Nest& nest) {
  return OverlapSearch(pieces, options, nest).run(context);
}

}  // namespace atlas::pack
