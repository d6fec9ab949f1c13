#include "libatlas/pack/gap_fill.h"

#include <algorithm>

namespace atlas::pack {

std::size_t GapFill::lowest_segment() const {
  std::size_t lowest = 0;
  for (std::size_t i = 1; i < skyline_.size(); ++i)
    if (skyline_[i].y < skyline_[lowest].y) lowest = i;
  return lowest;
}

GapFill::Choice GapFill::choose(std::span<const std::uint32_t> sequence, std::size_t gap) const {
  const Segment s = skyline_[gap];
  const std::int32_t left = (gap > 0 ? skyline_[gap - 1].y : page_.height) - s.y;
  const std::int32_t right = (gap + 1 < skyline_.size() ? skyline_[gap + 1].y : page_.height) - s.y;
  const std::int32_t room = page_.height - s.y;
  // Items that match neither wall are put against the taller one.
  const bool tall_right = right > left;
  const std::int32_t tall = tall_right ? right : left, low = tall_right ? left : right;
  Choice best;
  const auto consider = [&](Extent e, std::size_t i, bool turned) {
    if (e.width > s.width || e.height > room) return;
    int score = 0;
    bool other = false;
    if (e.width == s.width) {
      score = e.height == tall || e.height == low ? 8 : e.height > tall ? 5 : 4;
    } else if (best.score >= 3) {
      return;
    } else if (e.height == tall) {
      score = 3;
    } else if (e.height == low) {
      score = 2;
      other = true;
    }
    if (score > best.score) best = {score, i, turned, other != tall_right};
  };
  for (std::size_t i = 0; i < sequence.size() && best.score < 8; ++i) {
    const Extent item = items_[sequence[i]];
    consider(item, i, false);
    if (allow_rotation_ && item.width != item.height) consider({item.height, item.width}, i, true);
  }
  return best;
}

void GapFill::merge(std::size_t i) {
  if (i + 1 < skyline_.size() && skyline_[i + 1].y == skyline_[i].y) {
    skyline_[i].width += skyline_[i + 1].width;
    skyline_.erase(skyline_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
  }
  if (i > 0 && skyline_[i - 1].y == skyline_[i].y) {
    skyline_[i - 1].width += skyline_[i].width;
    skyline_.erase(skyline_.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

// Nothing fits the gap, so it is lifted to its lower wall, and its area is wasted.
void GapFill::raise(std::size_t gap) {
  std::int32_t level = page_.height;
  if (gap > 0) level = std::min(level, skyline_[gap - 1].y);
  if (gap + 1 < skyline_.size()) level = std::min(level, skyline_[gap + 1].y);
  skyline_[gap].y = level;
  merge(gap);
}

void GapFill::put(std::size_t gap, Extent size, bool at_right) {
  const Segment s = skyline_[gap];
  const Segment top{at_right ? s.x + s.width - size.width : s.x, s.y + size.height, size.width};
  if (size.width == s.width) {
    skyline_[gap] = top;
    merge(gap);
    return;
  }
  const auto at = skyline_.begin() + static_cast<std::ptrdiff_t>(gap);
  if (at_right) {
    at->width -= size.width;
    skyline_.insert(at + 1, top);
    merge(gap + 1);
  } else {
    at->x += size.width;
    at->width -= size.width;
    skyline_.insert(at, top);
    merge(gap);
  }
}

std::int32_t GapFill::fill(std::vector<std::uint32_t>& sequence) {
  skyline_.assign(1, {0, 0, page_.width});
  placed_area_ = 0;
  std::int32_t used = 0;
  while (!sequence.empty()) {
    const std::size_t gap = lowest_segment();
    if (skyline_[gap].y >= page_.height) break;
    const Choice c = choose(sequence, gap);
    if (c.score < 0) {
      raise(gap);
      continue;
    }
    const std::uint32_t id = sequence[c.index];
    Extent size = items_[id];
    if (c.rotated) std::swap(size.width, size.height);
    const Segment s = skyline_[gap];
    placed_.push_back({id, c.at_right ? s.x + s.width - size.width : s.x, s.y, c.rotated});
    placed_area_ += size.area();
    used = std::max(used, s.y + size.height);
    put(gap, size, c.at_right);
    sequence.erase(sequence.begin() + static_cast<std::ptrdiff_t>(c.index));
  }
  return used;
}

}  // namespace atlas::pack
