#include <algorithm>

#include "libatlas/pack/rectangles/engines.h"
#include "libatlas/pack/rectangles/gap_heap.h"
#include "libatlas/pack/rectangles/gap_index.h"

namespace atlas::pack {

Layout pack_gaps(const Problem& problem, std::span<const std::uint32_t> sequence) {
  Layout layout;
  layout.placements.resize(problem.items.size());
  layout.unplaced = static_cast<std::uint32_t>(sequence.size());
  // Before the index is built, which takes a third of the time.
  if (problem.cancelled()) return layout;
  GapIndex index(problem.items, sequence, problem.allow_rotation);
  std::size_t left = sequence.size();
  std::int64_t filled = 0;
  std::int32_t used = 0;
  for (; left > 0 && layout.pages < problem.max_pages && !problem.cancelled(); ++layout.pages) {
    GapHeap gaps(problem.page);
    filled = used = 0;
    while (left > 0) {
      if (left % kItemsAPoll == 0 && problem.cancelled()) break;
      const std::uint32_t gap = gaps.lowest();
      const GapHeap::Segment s = gaps.at(gap);
      const std::int32_t room = problem.page.height - s.y;
      if (index.lowest() > room) break;  // nor does any item fit a higher gap
      const std::int32_t l = gaps.height_of(s.left) - s.y, r = gaps.height_of(s.right) - s.y;
      const GapIndex::Choice c = index.choose({{s.width, room}, std::max(l, r), std::min(l, r)});
      if (c.rank == kNoRank) {
        gaps.raise(gap, s.y + std::min(l, r));
        continue;
      }
      const std::uint32_t item = sequence[c.rank / 2];
      const bool turned = c.rank & 1, at_right = c.at_low_wall != (r > l);
      Extent size = problem.items[item];
      if (turned) std::swap(size.width, size.height);
      layout.placements[item] = {layout.pages, at_right ? s.x + s.width - size.width : s.x, s.y,
                                 turned};
      filled += size.area();
      used = std::max(used, s.y + size.height);
      gaps.put(gap, size, at_right);
      index.remove(c.rank);
      --left;
    }
  }
  layout.unplaced = static_cast<std::uint32_t>(left);
  layout.last_used = layout.pages == 1 ? used : filled;
  return layout;
}

}  // namespace atlas::pack
