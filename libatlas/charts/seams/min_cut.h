// Internal: minimum cut of a graph whose nodes have at most three neighbours, as triangles have.
#pragma once

#include <cstdint>
#include <vector>

namespace atlas {

// Dinic 1970: shortest augmenting paths, a level graph at a time. Of all minimum cuts the one with
// the fewest nodes on side 0.
class MinCut {
 public:
  static constexpr std::int32_t kForever = std::int32_t{1} << 28;

  struct Arc {
    std::uint32_t node, slot;  // slot < 3
  };

  void reset(std::uint32_t node_count);
  // Both directions cost `weight` >= 0. To be called for one direction or for both alike.
  void set_edge(Arc from, Arc to, std::int32_t weight);
  // Leaving `side` (0 or 1) costs the node `weight` more.
  void tie(std::uint32_t node, std::uint32_t side, std::int32_t weight);

  void run();
  std::uint32_t side(std::uint32_t node) const { return level_[node] == kUnreached; }

 private:
  static constexpr std::uint32_t kUnreached = 0xffffffffu;

  // Four a node, though it has three: nothing need be divided by that.
  static std::uint32_t arc(std::uint32_t node, std::uint32_t slot) { return 4 * node + slot; }
  static std::uint32_t node(std::uint32_t arc) { return arc / 4; }

  bool find_levels();
  void augment();
  void augment_from(std::uint32_t root);
  void push(std::uint32_t root, std::uint32_t end);

  std::vector<std::uint32_t> reverse_;  // 1 an arc: the arc back, kUnreached: none
  std::vector<std::int32_t> capacity_;  // 1 an arc, what is left
  std::vector<std::int32_t> source_, sink_;
  std::vector<std::uint32_t> level_, queue_, path_;
  std::vector<std::uint8_t> next_;  // 1 a node: the arc to try next; 3: its way to the sink
};

}  // namespace atlas
