#include "libatlas/pack/rectangles/free_rects.h"

#include <algorithm>
#include <iterator>
#include <tuple>

#include "libatlas/core/sort_total.h"

namespace atlas::pack {
namespace {

bool intersect(const Rect& a, const Rect& b) {
  return a.x < b.right() && b.x < a.right() && a.y < b.top() && b.y < a.top();
}

bool contains(const Rect& outer, const Rect& inner) {
  return outer.x <= inner.x && outer.y <= inner.y && outer.right() >= inner.right() &&
         outer.top() >= inner.top();
}

bool below_left(const Rect& a, const Rect& b) {
  if (a.y != b.y) return a.y < b.y;
  if (a.x != b.x) return a.x < b.x;
  if (a.width != b.width) return a.width > b.width;
  return a.height > b.height;
}

std::int64_t overlap(std::int32_t a0, std::int32_t a1, std::int32_t b0, std::int32_t b1) {
  return std::max(0, std::min(a1, b1) - std::max(a0, b0));
}

}  // namespace

FreeRects::FreeRects(Extent page) : page_(page), free_{{0, 0, page.width, page.height}} {
  measure_room();
}

bool FreeRects::find(Extent item, bool allow_rotation, PlaceRule rule, Spot& spot) const {
  const auto one = [&](Extent size, Spot& s) {
    return rule == PlaceRule::contact ? find_contact(size, s) : find_bottom_left(size, s);
  };
  bool found = one(item, spot);
  if (found) spot.rotated = false;
  if (allow_rotation && item.width != item.height) {
    Spot turned;
    if (one({item.height, item.width}, turned) && (!found || turned.better_than(spot))) {
      spot = turned;
      spot.rotated = true;
      found = true;
    }
  }
  return found;
}

bool FreeRects::find_bottom_left(Extent item, Spot& spot) const {
  if (!room_.may_hold(item)) return false;
  for (const Rect& f : free_) {
    if (f.width < item.width || f.height < item.height) continue;
    spot.rect = {f.x, f.y, item.width, item.height};
    spot.first = f.y + item.height;
    spot.second = f.x;
    spot.third = 0;
    return true;
  }
  return false;
}

std::int64_t FreeRects::contact_length(const Rect& r) const {
  std::int64_t length = 0;
  if (r.x == 0) length += r.height;
  if (r.right() == page_.width) length += r.height;
  if (r.y == 0) length += r.width;
  if (r.top() == page_.height) length += r.width;
  for (const Rect& p : placed_) {
    if (p.x == r.right() || p.right() == r.x) length += overlap(p.y, p.top(), r.y, r.top());
    if (p.y == r.top() || p.top() == r.y) length += overlap(p.x, p.right(), r.x, r.right());
  }
  return length;
}

bool FreeRects::find_contact(Extent item, Spot& spot) const {
  bool found = false;
  for (const Rect& f : free_) {
    if (f.width < item.width || f.height < item.height) continue;
    Spot s;
    s.rect = {f.x, f.y, item.width, item.height};
    s.first = -contact_length(s.rect);
    s.second = s.rect.top();
    s.third = f.x;
    if (!found || s.better_than(spot)) {
      spot = s;
      found = true;
    }
  }
  return found;
}

FreeRects::Beside FreeRects::beside(Side side, const Rect& r, bool fresh) {
  switch (side) {
    case Side::left:
      return {side, fresh, r.x, r.y, r.top(), r};
    case Side::right:
      return {side, fresh, -r.right(), r.y, r.top(), r};
    case Side::below:
      return {side, fresh, r.y, r.x, r.right(), r};
    case Side::above:
      return {side, fresh, -r.top(), r.x, r.right(), r};
  }
  return {};
}

void FreeRects::split(const Rect& f, const Rect& t) {
  const auto keep = [&](Side side, const Rect& r) {
    if (r.width >= min_width_ && r.height >= min_height_) beside_.push_back(beside(side, r, true));
  };
  if (t.x > f.x) keep(Side::left, {f.x, f.y, t.x - f.x, f.height});
  if (t.right() < f.right()) keep(Side::right, {t.right(), f.y, f.right() - t.right(), f.height});
  if (t.y > f.y) keep(Side::below, {f.x, f.y, f.width, t.y - f.y});
  if (t.top() < f.top()) keep(Side::above, {f.x, t.top(), f.width, f.top() - t.top()});
}

// Notes a free rectangle that `taken` does not meet, if it touches a side of it.
void FreeRects::note_neighbour(const Rect& f, const Rect& t) {
  if (f.y < t.top() && t.y < f.top()) {
    if (f.right() == t.x) beside_.push_back(beside(Side::left, f, false));
    if (f.x == t.right()) beside_.push_back(beside(Side::right, f, false));
  } else if (f.x < t.right() && t.x < f.right()) {
    if (f.top() == t.y) beside_.push_back(beside(Side::below, f, false));
    if (f.y == t.top()) beside_.push_back(beside(Side::above, f, false));
  }
}

void FreeRects::place(const Rect& rect) {
  placed_.push_back(rect);
  used_height_ = std::max(used_height_, rect.top());
  beside_.clear();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < free_.size(); ++i) {
    const Rect f = free_[i];
    if (intersect(f, rect)) {
      split(f, rect);
      continue;
    }
    note_neighbour(f, rect);
    free_[kept++] = f;
  }
  free_.resize(kept);
  keep_maximal();
  measure_room();
}

// Adds the pieces that are maximal to the free rectangles. The rectangles that the placed one does
// not meet stay maximal: each piece lies within the maximal rectangle from which it was cut, so a
// rectangle within the piece would have been within that, too. A piece can only lie within a
// rectangle that ends at the same side of the placed one: a larger one that ends elsewhere would
// either meet the placed one, or it would be a piece beside it that does not reach as far along it.
// So each side is swept from the rectangles that begin farthest from it to the nearest. The front
// has the ends of those before, without those that lie within others: (low, high), both rising.
// With thousands of long thin items, all of which have pieces on one side, this takes O(n log n)
// an item where comparing all pairs took O(n^2).
void FreeRects::keep_maximal() {
  sort_total(beside_.begin(), beside_.end(), [](const Beside& a, const Beside& b) {
    return std::tuple(a.side, a.start, a.low, -a.high, a.fresh) <
           std::tuple(b.side, b.start, b.low, -b.high, b.fresh);
  });
  fresh_.clear();
  front_.clear();
  for (std::size_t i = 0; i < beside_.size(); ++i) {
    const Beside& r = beside_[i];
    if (i > 0 && beside_[i - 1].side != r.side) front_.clear();
    const auto after =
        std::upper_bound(front_.begin(), front_.end(), r.low,
                         [](std::int32_t low, const auto& ends) { return low < ends.first; });
    if (after != front_.begin() && std::prev(after)->second >= r.high) continue;
    // What begins at the same place ends before, and what begins behind it may.
    const bool same = after != front_.begin() && std::prev(after)->first == r.low;
    const auto first = same ? std::prev(after) : after;
    const auto last =
        std::find_if(after, front_.end(), [&](const auto& ends) { return ends.second > r.high; });
    front_.insert(front_.erase(first, last), {r.low, r.high});
    if (r.fresh) fresh_.push_back(r.rect);
  }
  sort_total(fresh_.begin(), fresh_.end(), below_left);
  const auto middle = static_cast<std::ptrdiff_t>(free_.size());
  free_.insert(free_.end(), fresh_.begin(), fresh_.end());
  std::inplace_merge(free_.begin(), free_.begin() + middle, free_.end(), below_left);
}

// Returns the maximal free rectangles that meet `rect`. While others are placed on an empty page,
// pieces that do not meet `rect` are dropped, because all that is cut from them would not, either.
std::vector<Rect> FreeRects::free_around(const Rect& rect) const {
  FreeRects around(page_);
  around.drop_smaller(min_width_, min_height_);
  for (const Rect& other : placed_) {
    const auto meets = [&](const Rect& f) { return intersect(f, other); };
    if (std::none_of(around.free_.begin(), around.free_.end(), meets)) continue;
    around.place(other);
    std::erase_if(around.free_, [&](const Rect& f) { return !intersect(f, rect); });
  }
  return around.free_;
}

void FreeRects::take_away(const Rect& rect) {
  placed_.erase(std::find(placed_.begin(), placed_.end(), rect));
  used_height_ = 0;
  for (const Rect& p : placed_) used_height_ = std::max(used_height_, p.top());
  fresh_ = free_around(rect);
  // None of these lies within another free rectangle, since only these meet `rect`.
  std::erase_if(free_, [&](const Rect& f) {
    return std::any_of(fresh_.begin(), fresh_.end(),
                       [&](const Rect& larger) { return contains(larger, f); });
  });
  const std::size_t middle = free_.size();
  free_.insert(free_.end(), fresh_.begin(), fresh_.end());
  std::inplace_merge(free_.begin(), free_.begin() + middle, free_.end(), below_left);
  measure_room();
}

void FreeRects::drop_smaller(std::int32_t width, std::int32_t height) {
  if (width <= min_width_ && height <= min_height_) return;
  min_width_ = std::max(min_width_, width);
  min_height_ = std::max(min_height_, height);
  std::erase_if(free_,
                [&](const Rect& r) { return r.width < min_width_ || r.height < min_height_; });
  measure_room();
}

void FreeRects::measure_room() {
  room_ = {};
  for (const Rect& f : free_) room_.add({f.width, f.height});
  room_.finish();
}

}  // namespace atlas::pack
