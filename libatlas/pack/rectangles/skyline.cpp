#include "libatlas/pack/rectangles/skyline.h"

#include <algorithm>
#include <bit>
#include <deque>

namespace atlas::pack {
namespace {

std::size_t bucket_of(Extent e) {
  const auto side = static_cast<std::uint32_t>(std::min(e.width, e.height));
  return static_cast<std::size_t>(std::bit_width(side));
}

}  // namespace

void WasteMap::add(const Rect& hole) {
  if (hole.width > 0 && hole.height > 0)
    buckets_[bucket_of({hole.width, hole.height})].push_back(hole);
}

bool WasteMap::take(Extent item, bool allow_rotation, Rect& place, bool& rotated) {
  for (std::size_t b = bucket_of(item); b < buckets_.size(); ++b) {
    std::vector<Rect>& holes = buckets_[b];
    const std::size_t tries = std::min(kTries, holes.size());
    std::size_t best = holes.size();
    for (std::size_t k = holes.size(); k-- > holes.size() - tries;) {
      const bool upright = holes[k].width >= item.width && holes[k].height >= item.height;
      const bool turned =
          allow_rotation && holes[k].width >= item.height && holes[k].height >= item.width;
      if (!upright && !turned) continue;
      if (best < holes.size() && holes[best].area() <= holes[k].area()) continue;
      best = k;
      rotated = !upright;
    }
    if (best == holes.size()) continue;
    const Rect hole = holes[best];
    holes[best] = holes.back();
    holes.pop_back();
    if (rotated) std::swap(item.width, item.height);
    place = {hole.x, hole.y, item.width, item.height};
    // The rest is cut such that the longer part stays whole.
    const std::int32_t right = hole.width - item.width, above = hole.height - item.height;
    const bool tall_right = right > above;
    add({hole.x + item.width, hole.y, right, tall_right ? hole.height : item.height});
    add({hole.x, hole.y + item.height, tall_right ? item.width : hole.width, above});
    return true;
  }
  return false;
}

std::size_t WasteMap::size() const {
  std::size_t count = 0;
  for (const auto& b : buckets_) count += b.size();
  return count;
}

Skyline::Skyline(Extent page) : page_(page), segments_{{0, 0, page.width}} {}

bool Skyline::find(Extent item, bool allow_rotation, PlaceRule rule, Spot& spot) {
  bool rotated = false;
  from_waste_ = {};
  if (waste_.take(item, allow_rotation, from_waste_, rotated)) {
    spot = {};
    spot.rect = from_waste_;
    spot.rotated = rotated;
    return true;
  }
  bool found = find_over(item, rule, spot);
  Spot turned;
  if (allow_rotation && item.width != item.height &&
      find_over({item.height, item.width}, rule, turned) && (!found || turned.better_than(spot))) {
    spot = turned;
    spot.rotated = true;
    found = true;
  }
  return found;
}

bool Skyline::find_over(Extent item, PlaceRule rule, Spot& spot) const {
  if (item.width > page_.width || item.height > page_.height) return false;
  // Candidates for the left end are the left ends of the segments. `below` is the area under the
  // skyline within the window [x, x + width). `highest` holds the window's segments with falling
  // heights.
  std::deque<std::size_t> highest;
  std::int64_t below = 0;
  std::size_t end = 0;  // the first segment that is not yet in `below`
  bool found = false;
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    const std::int32_t right = segments_[i].x + item.width;
    if (right > page_.width) break;
    for (; end < segments_.size() && segments_[end].x < right; ++end) {
      while (!highest.empty() && segments_[highest.back()].y <= segments_[end].y)
        highest.pop_back();
      highest.push_back(end);
      below += std::int64_t{segments_[end].y} * segments_[end].width;
    }
    while (highest.front() < i) highest.pop_front();
    const std::int32_t y = segments_[highest.front()].y;
    if (y <= page_.height - item.height) {
      const Segment& last = segments_[end - 1];
      const std::int64_t beyond = std::int64_t{last.y} * (last.x + last.width - right);
      const std::int64_t waste = std::int64_t{y} * item.width - (below - beyond);
      Spot s;
      s.rect = {segments_[i].x, y, item.width, item.height};
      const std::int64_t top = std::int64_t{y} + item.height;
      s.first = rule == PlaceRule::min_waste ? waste : top;
      s.second = rule == PlaceRule::min_waste ? top : waste;
      s.third = segments_[i].x;
      if (!found || s.better_than(spot)) spot = s;
      found = true;
    }
    below -= std::int64_t{segments_[i].y} * segments_[i].width;
  }
  return found;
}

void Skyline::place(const Rect& rect) {
  filled_ += rect.area();
  used_height_ = std::max(used_height_, rect.top());
  if (rect == from_waste_) {
    from_waste_ = {};
    return;
  }
  raise(rect, true);
}

void Skyline::block(const Rect& rect) {
  if (rect.area() == 0) return;
  // The space between the skyline and the rectangle is free. But another blocked rectangle may be
  // put there, so it does not become a hole of the waste map.
  raise(rect, false);
}

void Skyline::raise(const Rect& rect, bool keep_waste) {
  scratch_.clear();
  const auto add = [&](std::int32_t x, std::int32_t y, std::int32_t width) {
    if (width <= 0) return;
    if (!scratch_.empty() && scratch_.back().y == y)
      scratch_.back().width += width;
    else
      scratch_.push_back({x, y, width});
  };
  for (const Segment& s : segments_) {
    const std::int32_t from = std::max(s.x, rect.x), to = std::min(s.x + s.width, rect.right());
    if (from >= to) {
      add(s.x, s.y, s.width);
      continue;
    }
    add(s.x, s.y, from - s.x);
    if (keep_waste) waste_.add({from, s.y, to - from, rect.y - s.y});
    add(from, std::max(s.y, rect.top()), to - from);
    add(to, s.y, s.x + s.width - to);
  }
  segments_.swap(scratch_);
}

Room Skyline::room() const {
  std::int32_t lowest = page_.height;
  for (const Segment& s : segments_) lowest = std::min(lowest, s.y);
  Room room;
  // Holes may be as wide and as tall as the page, because their sizes are not tracked.
  if (waste_.size() > 0) lowest = 0;
  if (lowest < page_.height) room.add({page_.width, page_.height - lowest});
  room.finish();
  return room;
}

}  // namespace atlas::pack
