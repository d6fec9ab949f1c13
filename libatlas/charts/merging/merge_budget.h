// Internal: bounds the work of merging one piece, in proportion to the size of its coarse mesh.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace atlas {

// Work is counted in slots of the charts on trial, some 50 ns each. A trial takes time in
// proportion to the larger chart, so a large chart with thousands of small ones around it takes
// time in proportion to the square of their number. Beyond a first limit merging is thrifty:
//
// - Lopsided mergers come after all others. The small charts then join each other first, and few
//   are left.
// - A merger that failed is tried again only when one of its charts has doubled.
//
// Beyond a second limit, lopsided mergers are no longer tried, and beyond a third one only small
// unions are. Even mergers need little: a chart doubles in each.
//
// Pieces of ordinary meshes do not reach the first limit. The nearest of 83 meshes, a robot's hand
// of 6276 slots, takes six tenths of it, and most take less than a tenth. A toothed wheel with
// 64 000 slots, capped by fans around its hubs, took 600 million units (35 s), and takes 10 (1 s)
// for as many charts.
class MergeBudget {
 public:
  MergeBudget() = default;
  explicit MergeBudget(std::size_t slots) : limit_(kFreeWork + kWorkASlot * slots) {}

  // For a trial of two charts with that many slots in all. Testing whether the border crosses
  // itself is quadratic with a small factor.
  void count_trial(std::size_t slots) { work_ += slots + slots * slots / kCheapPairs; }
  // For sorting that many arcs of a chart, and pushing the neighbours across.
  void count_borders(std::size_t arcs) { work_ += kWorkAnArc * arcs; }
  // For looking through that many refusals.
  void count_refusals(std::size_t refusals) { work_ += refusals / kCheapRefusals; }

  bool thrifty() const { return work_ > limit_; }
  // Whether a merger of charts with that many slots comes after the others.
  bool postpones(std::size_t slots, std::size_t other) const {
    return thrifty() && lopsided(slots, other);
  }
  // Whether charts with that many slots may still be tried together.
  bool affords(std::size_t slots, std::size_t other) const {
    const std::uint64_t most = lopsided(slots, other) ? kMostLopsided : kMostEven;
    return work_ <= most * limit_ || slots + other <= kSmallUnion;
  }
  std::uint64_t work() const { return work_; }

 private:
  static bool lopsided(std::size_t slots, std::size_t other) {
    return kLopsided * std::min(slots, other) < std::max(slots, other);
  }

  static constexpr std::uint64_t kFreeWork = 1000000, kWorkASlot = 64;
  static constexpr std::uint64_t kMostLopsided = 2, kMostEven = 8;  // times the first limit
  static constexpr std::uint64_t kCheapPairs = 16384, kWorkAnArc = 2, kCheapRefusals = 16;
  static constexpr std::size_t kSmallUnion = 64, kLopsided = 8;

  std::uint64_t limit_ = kFreeWork, work_ = 0;
};

}  // namespace atlas
