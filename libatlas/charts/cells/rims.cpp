#include "libatlas/charts/cells/rims.h"

#include "libatlas/core/counting_sort.h"

namespace atlas {
namespace {

// A hole of the mesh counts as small, and is ignored, if its boundary loop is shorter than this
// share of the cell's longest loop.
constexpr double kSmallHole = 0.35;
constexpr int kDivideRounds = 8;

bool has_one_rim(std::span<const RimLoop> loops) {
  if (loops.empty()) return false;
  const std::size_t longest = longest_loop(loops);
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (i == longest) continue;
    if (!loops[i].open || loops[i].length > kSmallHole * loops[longest].length) return false;
  }
  return true;
}

// Divides cells in two by breadth-first growth from two triangles far from each other.
class Divider {
 public:
  Divider(const Topology& topology, Cells& cells) : topology_(topology), cells_(cells) {}

  void divide(const std::vector<std::uint32_t>& bad) {
    std::vector<std::vector<std::uint32_t>> lists(bad.size());
    std::vector<std::uint32_t> place(cells_.count, kNoIndex);
    for (std::uint32_t i = 0; i < bad.size(); ++i) place[bad[i]] = i;
    for (std::uint32_t t = 0; t < cells_.of_triangle.size(); ++t) {
      const std::uint32_t k = cells_.of_triangle[t];
      if (k != kNoIndex && place[k] != kNoIndex) lists[place[k]].push_back(t);
    }
    mark_.resize(cells_.of_triangle.size(), 0);
    for (const auto& list : lists) {
      if (list.size() > 1) divide_one(list);
    }
  }

 private:
  void divide_one(const std::vector<std::uint32_t>& list) {
    const std::uint32_t old = cells_.of_triangle[list[0]];
    for (const std::uint32_t t : list) mark_[t] = 0;
    flood({list[0]}, old, 1);
    const std::uint32_t a = queue_.back();
    flood({a}, old, 2);
    const std::uint32_t b = queue_.back();
    if (a == b) return;
    // Both parts grow at once; a polygon belongs to the one that reaches it first.
    queue_.clear();
    reach(a, old, 3);
    if (mark_[b] >= 3) return;  // a single polygon
    reach(b, old, 4);
    const std::uint32_t fresh = cells_.count++;
    for (std::size_t i = 0; i < queue_.size(); ++i) {
      const std::uint32_t t = queue_[i];
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t o = topology_.opposite[h];
        if (o == kNoIndex || cells_.of_triangle[o / 3] != old || mark_[o / 3] >= 3) continue;
        reach(o / 3, old, mark_[t]);
      }
    }
    for (const std::uint32_t t : queue_) {
      if (mark_[t] == 4) cells_.of_triangle[t] = fresh;
    }
  }

  // Adds a triangle to the queue, with the others of its polygon.
  void reach(std::uint32_t triangle, std::uint32_t cell, std::uint8_t mark) {
    mark_[triangle] = mark;
    const std::size_t first = queue_.size();
    queue_.push_back(triangle);
    if (topology_.polygon.empty()) return;
    for (std::size_t i = first; i < queue_.size(); ++i) {
      for (std::uint32_t h = 3 * queue_[i]; h < 3 * queue_[i] + 3; ++h) {
        if (!topology_.inner(h)) continue;
        const std::uint32_t mate = topology_.opposite[h] / 3;
        if (cells_.of_triangle[mate] != cell || mark_[mate] >= 3) continue;
        mark_[mate] = mark;
        queue_.push_back(mate);
      }
    }
  }

  void flood(std::vector<std::uint32_t> start, std::uint32_t cell, std::uint8_t mark) {
    queue_ = std::move(start);
    for (const std::uint32_t t : queue_) mark_[t] = mark;
    for (std::size_t i = 0; i < queue_.size(); ++i) {
      for (std::uint32_t h = 3 * queue_[i]; h < 3 * queue_[i] + 3; ++h) {
        const std::uint32_t o = topology_.opposite[h];
        if (o == kNoIndex || cells_.of_triangle[o / 3] != cell || mark_[o / 3] == mark) continue;
        mark_[o / 3] = mark;
        queue_.push_back(o / 3);
      }
    }
  }

  const Topology& topology_;
  Cells& cells_;
  std::vector<std::uint8_t> mark_;
  std::vector<std::uint32_t> queue_;
};

// Returns the cell across two or three of a triangle's edges, which may be its own; kNoIndex if
// there is none.
std::uint32_t most_around(const Topology& topology, const Regions* regions, const Cells& cells,
                          std::uint32_t t) {
  std::uint32_t around[3];
  for (std::uint32_t c = 0; c < 3; ++c) {
    const std::uint32_t o = topology.opposite[3 * t + c];
    const bool end = o == kNoIndex || (regions && regions->part(t, o / 3));
    around[c] = end ? kNoIndex : cells.of_triangle[o / 3];
  }
  if (around[0] == around[1] || around[0] == around[2]) return around[0];
  return around[1] == around[2] ? around[1] : kNoIndex;
}

}  // namespace

Rims::Rims(const Topology& topology, const Cells& cells) : topology_(topology), cells_(cells) {
  sort_by_cell();
  seen_.assign(topology_.opposite.size(), 0);
  path.reserve(rim_.size());
  first_loop_.reserve(cells_.count + 1);
  for (std::uint32_t k = 0; k < cells_.count; ++k) {
    first_loop_.push_back(static_cast<std::uint32_t>(loops_.size()));
    for (std::uint32_t i = first_[k]; i < first_[k + 1]; ++i) {
      if (!seen_[rim_[i]]) walk(rim_[i]);
    }
  }
  first_loop_.push_back(static_cast<std::uint32_t>(loops_.size()));
}

void Rims::sort_by_cell() {
  const auto n = static_cast<std::uint32_t>(topology_.opposite.size());
  std::vector<std::uint32_t> found;
  for (std::uint32_t h = 0; h < n; ++h) {
    if (on_rim(h)) found.push_back(h);
  }
  rim_.resize(found.size());
  first_ = counting_sort(
      found.size(), cells_.count, [&](std::size_t i) { return cell(found[i]); },
      [&](std::size_t i, std::uint32_t at) { rim_[at] = found[i]; });
}

void Rims::walk(std::uint32_t start) {
  RimLoop loop{static_cast<std::uint32_t>(path.size()), 0, 0, true};
  std::uint32_t h = start;
  while (!seen_[h]) {
    seen_[h] = 1;
    path.push_back(h);
    loop.open = loop.open && topology_.opposite[h] == kNoIndex;
    loop.length += edge_length(topology_, h);
    h = next_half_edge(h);
    while (!on_rim(h)) h = next_half_edge(topology_.opposite[h]);
  }
  loop.end = static_cast<std::uint32_t>(path.size());
  loops_.push_back(loop);
}

std::size_t longest_loop(std::span<const RimLoop> loops) {
  std::size_t longest = 0;
  for (std::size_t i = 1; i < loops.size(); ++i) {
    if (loops[i].length > loops[longest].length * (1 + 1e-4)) longest = i;
  }
  return longest;
}

void pull_teeth(const Topology& topology, const Regions* regions, Cells& cells) {
  std::vector<std::uint32_t> size(cells.count, 0), waiting;
  for (const std::uint32_t k : cells.of_triangle) {
    if (k != kNoIndex) ++size[k];
  }
  for (std::uint32_t start = 0; start < cells.of_triangle.size(); ++start) {
    waiting.push_back(start);
    while (!waiting.empty()) {
      const std::uint32_t t = waiting.back(), own = cells.of_triangle[t];
      waiting.pop_back();
      if (topology.inner(3 * t) || topology.inner(3 * t + 1) || topology.inner(3 * t + 2)) continue;
      const std::uint32_t to = most_around(topology, regions, cells, t);
      if (own == kNoIndex || to == own || to == kNoIndex || size[own] == 1) continue;
      --size[own];
      ++size[to];
      cells.of_triangle[t] = to;
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t o = topology.opposite[h];
        if (o != kNoIndex && cells.of_triangle[o / 3] != to) waiting.push_back(o / 3);
      }
    }
  }
}

Rims divide_rings(const Topology& topology, Cells& cells) {
  for (int round = 0; round < kDivideRounds; ++round) {
    Rims rims(topology, cells);
    std::vector<std::uint32_t> bad;
    for (std::uint32_t k = 0; k < cells.count; ++k) {
      if (!has_one_rim(rims.loops(k))) bad.push_back(k);
    }
    if (bad.empty()) return rims;
    Divider(topology, cells).divide(bad);
  }
  return {topology, cells};
}

}  // namespace atlas
