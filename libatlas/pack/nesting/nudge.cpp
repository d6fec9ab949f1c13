#include "libatlas/pack/nesting/nudge.h"

#include <algorithm>
#include <limits>

namespace atlas::pack {
namespace {

// Rounds without less overlap after which masks are taken to be stuck: with twice as many, settling
// takes a third longer and pages become no fuller.
constexpr int kVainNudges = 3;
constexpr std::int32_t kReach = 2;  // of a move, in cells

class Nudge {
 public:
  Nudge(const Extent& page, std::vector<PlacedMask>& masks, double& work)
      : page_(page), masks_(masks), work_(work), pairs_(masks) {
    for (const std::uint32_t i : pairs_.taking_part()) {
      PlacedMask& m = masks_[i];
      m.at.x = std::clamp(m.at.x, 0, page.width - m.mask->width);
      m.at.y = std::clamp(m.at.y, 0, page.height - m.mask->height);
    }
    begun_ = masks;
    pairs_.reset();
  }

  bool run() {
    std::int64_t least = pairs_.total();
    for (int vain = 0; vain <= kVainNudges && pairs_.total() > 0 && work_ > 0; ++vain) {
      pairs_.raise_weights();
      for (const std::uint32_t i : pairs_.taking_part()) {
        if (!pairs_.overlaps(i)) continue;
        masks_[i].at = lightest_near(i);
        pairs_.measure(i);
      }
      if (pairs_.total() >= least) continue;
      least = pairs_.total();
      vain = -1;
    }
    return pairs_.total() == 0;
  }

 private:
  // Of equally light places, returns the one that is nearest to where the mask was at first.
  BitPage::Place lightest_near(std::uint32_t i) {
    const BitPage::Place now = masks_[i].at, first = begun_[i].at;
    BitPage::Place best = now;
    std::int64_t least = std::numeric_limits<std::int64_t>::max(), nearest = 0;
    for (std::int32_t dy = -kReach; dy <= kReach; ++dy)
      for (std::int32_t dx = -kReach; dx <= kReach; ++dx) {
        const BitPage::Place at{now.x + dx, now.y + dy};
        if (!inside(i, at)) continue;
        const std::int64_t weight = weigh(i, at, least);
        const std::int64_t x = at.x - first.x, y = at.y - first.y, distance = x * x + y * y;
        if (weight > least || (weight == least && distance >= nearest)) continue;
        least = weight;
        nearest = distance;
        best = at;
      }
    return best;
  }

  bool inside(std::uint32_t i, BitPage::Place at) const {
    const Mask& mask = *masks_[i].mask;
    return at.x >= 0 && at.y >= 0 && at.x + mask.width <= page_.width &&
           at.y + mask.height <= page_.height;
  }

  // Returns any number above `most` if mask i is heavier there.
  std::int64_t weigh(std::uint32_t i, BitPage::Place at, std::int64_t most) {
    const PlacedMask moved{masks_[i].mask, at};
    std::int64_t weight = 0;
    for (const std::uint32_t j : pairs_.taking_part()) {
      if (j == i) continue;
      work_ -= shared_rows(moved, masks_[j]);
      weight += std::int64_t(pairs_.weight(i, j)) * shared_cells(moved, masks_[j]);
      if (weight > most) break;
    }
    return weight;
  }

  Extent page_;
  std::vector<PlacedMask>& masks_;
  double& work_;
  std::vector<PlacedMask> begun_;
  PairOverlaps pairs_;
};

}  // namespace

bool nudge_apart(const Extent& page, std::vector<PlacedMask>& masks, double& work) {
  return Nudge(page, masks, work).run();
}

}  // namespace atlas::pack
