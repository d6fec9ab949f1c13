#include "libatlas/pack/rectangles/strip_beam.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <unordered_set>

#include "libatlas/core/random.h"
#include "libatlas/core/sort_total.h"

namespace atlas::pack {
namespace {

std::uint64_t mixed(std::uint64_t value) {
  return Random(value).next();
}

}  // namespace

StripBeam::StripBeam(std::span<const Extent> items, std::int32_t width, bool allow_rotation)
    : items_(items), width_(width), allow_rotation_(allow_rotation), count_(items.size()) {
  std::map<std::pair<std::int32_t, std::int32_t>, std::vector<std::uint32_t>> same;
  for (std::uint32_t i = 0; i < items.size(); ++i) {
    Extent e = items[i];
    if (allow_rotation && e.width < e.height) std::swap(e.width, e.height);
    same[{-e.width, -e.height}].push_back(i);
    total_ += e.area();
  }
  mean_ = static_cast<double>(total_) / static_cast<double>(count_);
  for (auto& [size, ids] : same) kinds_.push_back({{-size.first, -size.second}, std::move(ids)});
  by_side_.resize(kinds_.size());
  std::iota(by_side_.begin(), by_side_.end(), 0u);
  const auto side = [&](std::uint32_t k) {
    const Extent e = kinds_[k].size;
    return allow_rotation ? std::min(e.width, e.height) : e.width;
  };
  std::stable_sort(by_side_.begin(), by_side_.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return side(a) < side(b); });
}

StripBeam::State StripBeam::empty_strip() const {
  State state;
  state.skyline = {{0, 0, width_}};
  for (const Kind& k : kinds_) state.left.push_back(static_cast<std::uint16_t>(k.items.size()));
  return state;
}

std::size_t StripBeam::lowest(const std::vector<Segment>& skyline) {
  std::size_t lowest = 0;
  for (std::size_t i = 1; i < skyline.size(); ++i)
    if (skyline[i].y < skyline[lowest].y) lowest = i;
  return lowest;
}

void StripBeam::merge(std::vector<Segment>& skyline, std::size_t i) {
  if (i + 1 < skyline.size() && skyline[i + 1].y == skyline[i].y) {
    skyline[i].width += skyline[i + 1].width;
    skyline.erase(skyline.begin() + static_cast<std::ptrdiff_t>(i) + 1);
  }
  if (i > 0 && skyline[i - 1].y == skyline[i].y) {
    skyline[i - 1].width += skyline[i].width;
    skyline.erase(skyline.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

// Returns the height of the wall beside a segment, measured from the segment. The strip's sides are
// walls up to its top.
std::int32_t StripBeam::wall(const State& state, std::size_t gap, bool right) const {
  const auto& s = state.skyline;
  if (right) return (gap + 1 < s.size() ? s[gap + 1].y : height_) - s[gap].y;
  return (gap > 0 ? s[gap - 1].y : height_) - s[gap].y;
}

// Gives up a gap: it is lifted to its lower wall.
void StripBeam::raise(State& state, std::size_t gap) const {
  const std::int32_t up = std::min(wall(state, gap, false), wall(state, gap, true));
  state.waste += std::int64_t{up} * state.skyline[gap].width;
  state.skyline[gap].y += up;
  merge(state.skyline, gap);
}

std::int32_t StripBeam::smallest_left(State& state) const {
  while (state.smallest < by_side_.size() && state.left[by_side_[state.smallest]] == 0)
    ++state.smallest;
  if (state.smallest == by_side_.size()) return 0;
  const Extent e = kinds_[by_side_[state.smallest]].size;
  return allow_rotation_ ? std::min(e.width, e.height) : e.width;
}

// Gives up gaps between two walls that are too narrow for every item left. Returns false if the
// waste then exceeds what is allowed.
bool StripBeam::close_narrow_gaps(State& state) const {
  const std::int32_t least = smallest_left(state);
  for (std::size_t i = 0; i < state.skyline.size() && state.skyline.size() > 1;) {
    if (state.skyline[i].width < least && wall(state, i, false) > 0 && wall(state, i, true) > 0) {
      raise(state, i);
      i = 0;
    } else {
      ++i;
    }
  }
  return state.waste <= allowed_waste_;
}

// Finds the lowest gap that some item left fits. Lower gaps are given up. Returns false if that
// wastes too much.
bool StripBeam::next_gap(State& state, std::size_t& gap) const {
  while (state.waste <= allowed_waste_) {
    gap = lowest(state.skyline);
    const Segment s = state.skyline[gap];
    const std::int32_t room = height_ - s.y;
    if (room <= 0) return false;
    for (std::size_t k = 0; k < kinds_.size(); ++k) {
      if (state.left[k] == 0) continue;
      const Extent e = kinds_[k].size;
      if ((e.width <= s.width && e.height <= room) ||
          (allow_rotation_ && e.height <= s.width && e.width <= room))
        return true;
    }
    raise(state, gap);
  }
  return false;
}

Extent StripBeam::turned(const Child& child) const {
  const Extent e = kinds_[child.kind].size;
  return child.rotated ? Extent{e.height, e.width} : e;
}

// Returns area^large_first_. A library's power function took a quarter of the time of a search.
double StripBeam::weight(double area) const {
  const auto halves = static_cast<int>(2 * large_first_);
  double power = halves % 2 ? std::sqrt(area) : 1;
  for (int k = 0; k < halves / 2; ++k) power *= area;
  return power;
}

// The guide is the waste, plus a share of the mean item's area for every segment of the skyline,
// divided by a power of the area placed. The power expresses how much large items are preferred.
// The weights were tuned on zero-waste strips. Half or twice of each is only slightly worse.
void StripBeam::try_child(const State& state, const Gap& gap, Extent e, Child child) {
  constexpr double kBase = 0.02, kSegment = 0.05;
  const std::int32_t near = child.at_right ? gap.right : gap.left;
  const std::int32_t far = child.at_right ? gap.left : gap.right, rest = gap.width - e.width;
  double waste = static_cast<double>(state.waste);
  double segments = static_cast<double>(state.skyline.size());
  if (rest == 0) {
    segments -= (e.height == near) + (e.height == far);
  } else {
    segments += 1 - (e.height == near);
    if (rest < gap.least) {
      waste += double(rest) * std::min(e.height, far);
      segments -= 1;
    }
  }
  if (waste > static_cast<double>(allowed_waste_)) return;
  const double area = static_cast<double>(state.area + e.area());
  child.guide = (waste + mean_ * (kBase + kSegment * (segments - 1))) / weight(area);
  children_.push_back(child);
}

void StripBeam::add_children(std::uint32_t index, State& state) {
  std::size_t at = 0;
  if (!next_gap(state, at)) return;
  const Segment s = state.skyline[at];
  const Gap gap{s.width, height_ - s.y, wall(state, at, false), wall(state, at, true),
                smallest_left(state)};
  for (std::uint32_t k = 0; k < kinds_.size(); ++k) {
    if (state.left[k] == 0) continue;
    const Extent size = kinds_[k].size;
    for (int turn = 0; turn < 1 + (allow_rotation_ && size.width != size.height); ++turn) {
      const Extent e = turn ? Extent{size.height, size.width} : size;
      if (e.width > gap.width || e.height > gap.room) continue;
      for (int right = 0; right < (e.width == gap.width ? 1 : 2); ++right)
        try_child(state, gap, e, {0, index, k, turn == 1, right == 1});
    }
  }
}

// Puts the child's item into the lowest gap. Returns false if the waste exceeds what is allowed.
bool StripBeam::grow(const Child& child, State& state) const {
  auto& skyline = state.skyline;
  const std::size_t gap = lowest(skyline);
  const Segment s = skyline[gap];
  const Extent e = turned(child);
  const Segment top{child.at_right ? s.x + s.width - e.width : s.x, s.y + e.height, e.width};
  const auto at = skyline.begin() + static_cast<std::ptrdiff_t>(gap);
  if (e.width == s.width) {
    *at = top;
    merge(skyline, gap);
  } else {
    at->width -= e.width;
    if (!child.at_right) at->x += e.width;
    skyline.insert(at + (child.at_right ? 1 : 0), top);
    merge(skyline, gap + (child.at_right ? 1 : 0));
  }
  --state.left[child.kind];
  state.area += e.area();
  state.contents += mixed(child.kind);
  return close_narrow_gaps(state);
}

// Equal for partial layouts with the same items and the same or a mirrored skyline.
std::uint64_t StripBeam::fingerprint(const State& state) const {
  std::uint64_t shape = 0, mirror = 0;
  for (const Segment& s : state.skyline) {
    const auto key = [&](std::int32_t x) {
      return mixed((std::uint64_t(x) << 32 | std::uint32_t(s.y)) ^ mixed(std::uint64_t(s.width)));
    };
    shape += key(s.x);
    mirror += key(width_ - s.x - s.width);
  }
  return state.contents ^ mixed(std::min(shape, mirror));
}

std::vector<GapPlacement> StripBeam::trace(std::uint32_t node) const {
  std::vector<GapPlacement> placed;
  std::vector<std::size_t> used(kinds_.size());
  for (; node > 0; node = nodes_[node].parent) {
    const Node& n = nodes_[node];
    const std::uint32_t item = kinds_[n.kind].items[used[n.kind]++];
    const Extent e = turned({0, 0, n.kind, n.rotated, false});
    placed.push_back({item, n.x, n.y, !(items_[item] == e)});
  }
  return placed;
}

std::vector<GapPlacement> StripBeam::pack(const Limits& limits) {
  const std::size_t states = limits.states;
  height_ = limits.height;
  large_first_ = limits.large_first;
  allowed_waste_ = std::int64_t{width_} * height_ - total_;
  if (allowed_waste_ < 0) return {};
  const auto before = [](const Child& a, const Child& b) {
    return std::tie(a.guide, a.state, a.kind, a.rotated, a.at_right) <
           std::tie(b.guide, b.state, b.kind, b.rotated, b.at_right);
  };
  nodes_.assign(1, {});
  std::vector<State> current{empty_strip()}, next;
  std::unordered_set<std::uint64_t> seen;
  for (std::size_t placed = 0; placed < count_; ++placed) {
    children_.clear();
    for (std::uint32_t i = 0; i < current.size(); ++i) add_children(i, current[i]);
    // More children than needed are kept, because some turn out to be duplicates or to waste too
    // much.
    const std::size_t enough = std::min(children_.size(), 3 * states);
    nth_total(children_.begin(), children_.begin() + static_cast<std::ptrdiff_t>(enough),
              children_.end(), before);
    children_.resize(enough);
    sort_total(children_.begin(), children_.end(), before);
    next.clear();
    seen.clear();
    for (const Child& child : children_) {
      if (next.size() == states) break;
      State state = current[child.state];
      const Segment s = state.skyline[lowest(state.skyline)];
      if (!grow(child, state) || !seen.insert(fingerprint(state)).second) continue;
      const std::int32_t x = child.at_right ? s.x + s.width - turned(child).width : s.x;
      nodes_.push_back({state.node, child.kind, x, s.y, child.rotated});
      state.node = static_cast<std::uint32_t>(nodes_.size() - 1);
      next.push_back(std::move(state));
    }
    std::swap(current, next);
    if (current.empty() || (limits.stop && limits.stop())) return {};
  }
  return trace(current.front().node);
}

}  // namespace atlas::pack
