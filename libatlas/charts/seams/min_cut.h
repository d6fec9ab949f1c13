// Internal: minimum cut of a graph whose nodes have at most three neighbours, like triangles.
#pragma once

#include <cstdint>
#include <vector>

namespace atlas {

// Dinic's algorithm (1970): shortest augmenting paths, one level graph at a time. Of all minimum
// cuts it finds the one with the fewest nodes on side 0.
class MinCut {
 public:
  static constexpr std::int32_t kForever = std::int32_t{1} << 28;

  struct Arc {
    std::uint32_t node, slot;  // slot < 3
  };

  void reset(std::uint32_t node_count);
  // Sets the cost of an edge in both directions, `weight` >= 0. Must be called once per edge, or
  // for both directions alike.
  void set_edge(Arc from, Arc to, std::int32_t weight);
  // Adds `weight` to the cost of the node's leaving `side` (0 or 1).
  void tie(std::uint32_t node, std::uint32_t side, std::int32_t weight);

  void run();
  std::uint32_t side(std::uint32_t node) const { return level_[node] == kUnreached; }

 private:
  static constexpr std::uint32_t kUnreached = 0xffffffffu;

  // Each node has four arcs, of which three are used, so that indices need no division by three.
  static std::uint32_t arc(std::uint32_t node, std::uint32_t slot) { return 4 * node + slot; }
  static std::uint32_t node(std::uint32_t arc) { return arc / 4; }

  bool find_levels();
  void augment();
  void augment_from(std::uint32_t root);
  void push(std::uint32_t root, std::uint32_t end);

  std::vector<std::uint32_t> reverse_;  // one per arc: the arc back; kUnreached: none
  std::vector<std::int32_t> capacity_;  // one per arc: the remaining capacity
  std::vector<std::int32_t> source_, sink_;
  std::vector<std::uint32_t> level_, queue_, path_;
  std::vector<std::uint8_t> next_;  // one per node: the arc to try next; 3: none is left
};

}  // namespace atlas
