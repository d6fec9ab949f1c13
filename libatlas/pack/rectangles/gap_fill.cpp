#include "libatlas/pack/rectangles/gap_fill.h"

#include <algorithm>

namespace atlas::pack {
namespace {

// Items are looked at in blocks of this many, because compilers make vector instructions of the
// tests below: their loops have a fixed length and no branches.
constexpr std::size_t kBlock = 16;

// If fewer items than this remain, looking at one after the other is faster.
constexpr std::size_t kFewItems = 64;

// These tests say whether any item of a block may be chosen: the first item needs only fit. A
// better one is as wide as the gap or as high as a wall, then as wide as the gap.
struct AnyFits {
  std::int32_t width, room;
  bool operator()(const std::int32_t* w, const std::int32_t* h) const {
    std::int32_t any = 0;
    for (std::size_t k = 0; k < kBlock; ++k)
      any |= (w[k] <= width ? -1 : 0) & (h[k] <= room ? -1 : 0);
    return any;
  }
};
struct AnyMatches {
  std::int32_t width, tall, low;
  bool operator()(const std::int32_t* w, const std::int32_t* h) const {
    std::int32_t any = 0;
    for (std::size_t k = 0; k < kBlock; ++k)
      any |= (w[k] == width ? -1 : 0) | (h[k] == tall ? -1 : 0) | (h[k] == low ? -1 : 0);
    return any;
  }
};
struct AnyAsWide {
  std::int32_t width;
  bool operator()(const std::int32_t* w, const std::int32_t*) const {
    std::int32_t any = 0;
    for (std::size_t k = 0; k < kBlock; ++k) any |= w[k] == width ? -1 : 0;
    return any;
  }
};

}  // namespace

std::size_t GapFill::lowest_segment() const {
  std::size_t lowest = 0;
  for (std::size_t i = 1; i < skyline_.size(); ++i)
    if (skyline_[i].y < skyline_[lowest].y) lowest = i;
  return lowest;
}

// Returns the beginning of the first block, from i on, of which an item passes the test in an
// allowed direction, or of the last few blocks.
template <class Test>
std::size_t GapFill::next_block(std::size_t i, Test any) const {
  const std::int32_t *w = widths_.data(), *h = heights_.data();
  for (; i + kFewItems <= widths_.size(); i += kBlock)
    if (any(w + i, h + i) || (allow_rotation_ && any(h + i, w + i))) break;
  return i;
}

GapFill::Choice GapFill::choose(std::size_t gap) const {
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
  for (std::size_t i = 0; i < widths_.size() && best.score < 8;) {
    i = best.score < 0   ? next_block(i, AnyFits{s.width, room})
        : best.score < 3 ? next_block(i, AnyMatches{s.width, tall, low})
                         : next_block(i, AnyAsWide{s.width});
    const std::size_t end = i + kFewItems <= widths_.size() ? i + kBlock : widths_.size();
    for (; i < end && best.score < 8; ++i) {
      const Extent item{widths_[i], heights_[i]};
      consider(item, i, false);
      if (allow_rotation_ && item.width != item.height)
        consider({item.height, item.width}, i, true);
    }
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
  widths_.clear();
  heights_.clear();
  for (const std::uint32_t id : sequence) {
    widths_.push_back(items_[id].width);
    heights_.push_back(items_[id].height);
  }
  while (!sequence.empty()) {
    const std::size_t gap = lowest_segment();
    if (skyline_[gap].y >= page_.height) break;
    const Choice c = choose(gap);
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
    const auto index = static_cast<std::ptrdiff_t>(c.index);
    sequence.erase(sequence.begin() + index);
    widths_.erase(widths_.begin() + index);
    heights_.erase(heights_.begin() + index);
  }
  return used;
}

}  // namespace atlas::pack
