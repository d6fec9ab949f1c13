#include "libatlas/charts/seams/min_cut.h"

#include <algorithm>

namespace atlas {

void MinCut::reset(std::uint32_t node_count) {
  reverse_.assign(arc(node_count, 0), kUnreached);
  capacity_.assign(arc(node_count, 0), 0);
  source_.assign(node_count, 0);
  sink_.assign(node_count, 0);
}

void MinCut::set_edge(Arc from, Arc to, std::int32_t weight) {
  const std::uint32_t a = arc(from.node, from.slot), b = arc(to.node, to.slot);
  reverse_[a] = b;
  reverse_[b] = a;
  capacity_[a] = capacity_[b] = weight;
}

void MinCut::tie(std::uint32_t node, std::uint32_t side, std::int32_t weight) {
  (side == 0 ? source_ : sink_)[node] += weight;
}

void MinCut::run() {
  for (std::size_t i = 0; i < source_.size(); ++i) {
    const std::int32_t through = std::min(source_[i], sink_[i]);
    source_[i] -= through;
    sink_[i] -= through;
  }
  while (find_levels()) augment();
}

// Finds the levels of all nodes that the source still reaches. Returns whether the sink is among
// them.
bool MinCut::find_levels() {
  level_.assign(source_.size(), kUnreached);
  queue_.clear();
  for (std::uint32_t i = 0; i < source_.size(); ++i) {
    if (source_[i] == 0) continue;
    level_[i] = 0;
    queue_.push_back(i);
  }
  bool found = false;
  for (std::size_t k = 0; k < queue_.size(); ++k) {
    const std::uint32_t i = queue_[k];
    found |= sink_[i] > 0;
    for (std::uint32_t a = arc(i, 0); a < arc(i, 3); ++a) {
      if (capacity_[a] == 0) continue;
      const std::uint32_t j = node(reverse_[a]);
      if (level_[j] != kUnreached) continue;
      level_[j] = level_[i] + 1;
      queue_.push_back(j);
    }
  }
  return found;
}

void MinCut::augment() {
  next_.assign(source_.size(), 0);
  for (std::uint32_t i = 0; i < source_.size(); ++i) {
    if (level_[i] == 0) augment_from(i);
  }
}

// Pushes flow along paths of rising level, until the root has none left or no path continues.
void MinCut::augment_from(std::uint32_t root) {
  path_.clear();  // arcs
  std::uint32_t at = root;
  for (;;) {
    if (sink_[at] > 0) {
      push(root, at);
      if (source_[root] == 0) return;
      at = path_.empty() ? root : node(reverse_[path_.back()]);
      continue;
    }
    std::uint8_t& slot = next_[at];
    while (slot < 3) {
      const std::uint32_t a = arc(at, slot);
      if (capacity_[a] > 0 && level_[node(reverse_[a])] == level_[at] + 1) break;
      ++slot;
    }
    if (slot < 3) {
      path_.push_back(arc(at, slot));
      at = node(reverse_[path_.back()]);
    } else if (path_.empty()) {
      return;
    } else {
      at = node(path_.back());
      path_.pop_back();
      ++next_[at];
    }
  }
}

// Pushes as much flow as the path admits, and shortens the path to the part before the first full
// arc.
void MinCut::push(std::uint32_t root, std::uint32_t end) {
  std::int32_t flow = std::min(source_[root], sink_[end]);
  for (const std::uint32_t a : path_) flow = std::min(flow, capacity_[a]);
  source_[root] -= flow;
  sink_[end] -= flow;
  std::size_t open = path_.size();
  for (std::size_t k = path_.size(); k-- > 0;) {
    const std::uint32_t a = path_[k];
    capacity_[a] -= flow;
    capacity_[reverse_[a]] += flow;
    if (capacity_[a] == 0) open = k;
  }
  path_.resize(open);
}

}  // namespace atlas
