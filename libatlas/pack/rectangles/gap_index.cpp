#include "libatlas/pack/rectangles/gap_index.h"

#include <algorithm>
#include <bit>

#include "libatlas/core/sort_total.h"

namespace atlas::pack {
namespace {

bool before(const Extent& a, const Extent& b) {
  return a.width != b.width ? a.width < b.width : a.height < b.height;
}

std::vector<RankedExtent> entries_of(std::span<const Extent> items,
                                     std::span<const std::uint32_t> sequence, bool allow_rotation) {
  std::vector<RankedExtent> entries;
  for (std::uint32_t i = 0; i < sequence.size(); ++i) {
    const Extent e = items[sequence[i]];
    entries.push_back({e, 2 * i});
    if (allow_rotation && e.width != e.height) entries.push_back({{e.height, e.width}, 2 * i + 1});
  }
  return entries;
}

std::vector<RankedExtent> swapped(std::vector<RankedExtent> entries) {
  for (RankedExtent& e : entries) std::swap(e.size.width, e.size.height);
  return entries;
}

}  // namespace

SizeTable::SizeTable(std::vector<RankedExtent> entries, std::size_t ranks)
    : place_(ranks), leaves_(std::bit_ceil(entries.size() + 1)), least_(2 * leaves_, kNoRank) {
  sort_total(entries.begin(), entries.end(), [](const RankedExtent& a, const RankedExtent& b) {
    return a.size == b.size ? a.rank < b.rank : before(a.size, b.size);
  });
  sizes_.reserve(entries.size());
  for (const RankedExtent& e : entries) {
    place_[e.rank] = static_cast<std::uint32_t>(sizes_.size());
    least_[leaves_ + sizes_.size()] = e.rank;
    sizes_.push_back(e.size);
  }
  for (std::size_t n = leaves_ - 1; n >= 1; --n)
    least_[n] = std::min(least_[2 * n], least_[2 * n + 1]);
}

std::size_t SizeTable::from(std::int32_t width, std::int32_t height) const {
  const auto at = std::lower_bound(sizes_.begin(), sizes_.end(), Extent{width, height}, before);
  return static_cast<std::size_t>(at - sizes_.begin());
}

std::uint32_t SizeTable::of_width(std::int32_t width, std::int32_t low, std::int32_t high) const {
  if (low > high) return kNoRank;
  std::uint32_t best = kNoRank;
  std::size_t a = leaves_ + from(width, low), b = leaves_ + from(width, high + 1);
  for (; a < b; a /= 2, b /= 2) {
    if (a & 1) best = std::min(best, least_[a++]);
    if (b & 1) best = std::min(best, least_[--b]);
  }
  return best;
}

std::int32_t SizeTable::least_width() const {
  if (least_[1] == kNoRank) return INT32_MAX;
  std::size_t node = 1;
  while (node < leaves_) node = 2 * node + (least_[2 * node] == kNoRank);
  return sizes_[node - leaves_].width;
}

void SizeTable::remove(std::uint32_t rank) {
  std::size_t node = leaves_ + place_[rank];
  least_[node] = kNoRank;
  for (node /= 2; node >= 1; node /= 2) {
    const std::uint32_t least = std::min(least_[2 * node], least_[2 * node + 1]);
    if (least_[node] == least) break;
    least_[node] = least;
  }
}

FittingTree::FittingTree(std::vector<RankedExtent> entries, std::size_t ranks)
    : entries_(std::move(entries)),
      leaves_(std::bit_ceil((entries_.size() + kLeaf - 1) / kLeaf + 1)),
      nodes_(2 * leaves_),
      leaf_(leaves_),
      place_(ranks) {
  build(1, {0, entries_.size()}, true);
  for (std::uint32_t i = 0; i < entries_.size(); ++i) place_[entries_[i].rank] = i;
}

void FittingTree::build(std::size_t node, Range range, bool by_width) {
  Node& n = nodes_[node];
  n.low = {INT32_MAX, INT32_MAX};
  const auto first = entries_.begin() + static_cast<std::ptrdiff_t>(range.begin);
  const auto last = entries_.begin() + static_cast<std::ptrdiff_t>(range.end);
  for (auto e = first; e != last; ++e) {
    n.low = {std::min(n.low.width, e->size.width), std::min(n.low.height, e->size.height)};
    n.high = {std::max(n.high.width, e->size.width), std::max(n.high.height, e->size.height)};
    n.least = std::min(n.least, e->rank);
  }
  if (node >= leaves_) {
    leaf_[node - leaves_] = range;
    return;
  }
  const std::size_t middle = (range.begin + range.end) / 2;
  if (range.begin < range.end)
    nth_total(first, entries_.begin() + static_cast<std::ptrdiff_t>(middle), last,
              [&](const RankedExtent& a, const RankedExtent& b) {
                const std::int32_t p = by_width ? a.size.width : a.size.height;
                const std::int32_t q = by_width ? b.size.width : b.size.height;
                return p != q ? p < q : a.rank < b.rank;
              });
  build(2 * node, {range.begin, middle}, !by_width);
  build(2 * node + 1, {middle, range.end}, !by_width);
}

void FittingTree::descend(std::size_t node, Extent room, std::uint32_t& best) const {
  const Node& n = nodes_[node];
  if (n.least >= best || n.low.width > room.width || n.low.height > room.height) return;
  if (n.high.width <= room.width && n.high.height <= room.height) {
    best = n.least;
    return;
  }
  if (node >= leaves_) {
    const Range range = leaf_[node - leaves_];
    for (std::size_t i = range.begin; i < range.end; ++i) {
      const RankedExtent& e = entries_[i];
      if (e.size.width <= room.width && e.size.height <= room.height) best = std::min(best, e.rank);
    }
    return;
  }
  const bool second = nodes_[2 * node + 1].least < nodes_[2 * node].least;
  descend(2 * node + second, room, best);
  descend(2 * node + !second, room, best);
}

std::uint32_t FittingTree::first(Extent room) const {
  std::uint32_t best = kNoRank;
  descend(1, room, best);
  return best;
}

void FittingTree::remove(std::uint32_t rank) {
  // The leaf of an entry follows from how build() halves ranges.
  const std::size_t at = place_[rank];
  Range range{0, entries_.size()};
  std::size_t node = 1;
  while (node < leaves_) {
    const std::size_t middle = (range.begin + range.end) / 2;
    node = 2 * node + (at >= middle);
    (at >= middle ? range.begin : range.end) = middle;
  }
  entries_[at].rank = kNoRank;
  std::uint32_t least = kNoRank;
  for (std::size_t i = range.begin; i < range.end; ++i) least = std::min(least, entries_[i].rank);
  for (; node >= 1 && nodes_[node].least != least; node /= 2) {
    nodes_[node].least = least;
    if (node > 1) least = std::min(nodes_[node].least, nodes_[node ^ 1].least);
  }
}

GapIndex::GapIndex(std::span<const Extent> items, std::span<const std::uint32_t> sequence,
                   bool allow_rotation)
    : GapIndex(entries_of(items, sequence, allow_rotation), 2 * sequence.size()) {}

GapIndex::GapIndex(const std::vector<RankedExtent>& entries, std::size_t ranks)
    : has_(ranks),
      widths_(entries, ranks),
      heights_(swapped(entries), ranks),
      fitting_(entries, ranks) {
  for (const RankedExtent& e : entries) has_[e.rank] = 1;
}

std::uint32_t GapIndex::as_wide_as(const Gap& gap) const {
  const auto of_heights = [&](std::int32_t low, std::int32_t high) {
    return widths_.of_width(gap.room.width, low, std::min(high, gap.room.height));
  };
  const std::uint32_t any = of_heights(1, gap.room.height);
  if (any == kNoRank) return kNoRank;
  const std::uint32_t level =
      std::min(of_heights(gap.tall, gap.tall), of_heights(gap.low, gap.low));
  if (level != kNoRank) return level;
  const std::uint32_t higher = of_heights(gap.tall + 1, gap.room.height);
  return higher != kNoRank ? higher : any;
}

GapIndex::Choice GapIndex::choose(const Gap& gap) const {
  if (const std::uint32_t rank = as_wide_as(gap); rank != kNoRank) return {rank, false};
  for (const std::int32_t wall : {gap.tall, gap.low}) {
    if (wall > gap.room.height) continue;
    const std::uint32_t rank = heights_.of_width(wall, 1, gap.room.width);
    if (rank != kNoRank) return {rank, wall != gap.tall};
  }
  return {fitting_.first(gap.room), false};
}

void GapIndex::remove(std::uint32_t rank) {
  for (const std::uint32_t r : {rank & ~1u, rank | 1u}) {
    if (!has_[r]) continue;
    widths_.remove(r);
    heights_.remove(r);
    fitting_.remove(r);
  }
}

}  // namespace atlas::pack
