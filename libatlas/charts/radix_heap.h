// Internal: a priority queue for keys that never fall below the last one taken.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <vector>

namespace atlas {

// Ahuja, Mehlhorn, Orlin and Tarjan 1990, "Faster algorithms for the shortest path problem":
// entries lie in buckets by the highest bit in which their key differs from the last key taken. An
// entry moves to lower buckets only, one sequential pass each, where a binary heap jumps through
// memory at every step. Entry has a `key` and is ordered by operator>, key first.
template <class Entry>
class RadixHeap {
 public:
  bool empty() const { return size_ == 0; }

  // Allows for any key again. Precondition: empty.
  void restart() { last_ = 0; }

  // Precondition: the key is not below that of the last entry taken since the last restart.
  void push(const Entry& entry) {
    ++size_;
    put(entry);
  }

  // The smallest entry, taken out. Precondition: not empty.
  Entry pop() {
    if (buckets_[0].empty()) refill();
    std::pop_heap(buckets_[0].begin(), buckets_[0].end(), std::greater<>{});
    const Entry entry = buckets_[0].back();
    buckets_[0].pop_back();
    --size_;
    return entry;
  }

 private:
  void put(const Entry& entry) {
    const auto bucket = static_cast<std::size_t>(std::bit_width(entry.key ^ last_));
    buckets_[bucket].push_back(entry);
    if (bucket == 0) std::push_heap(buckets_[0].begin(), buckets_[0].end(), std::greater<>{});
  }

  void refill() {
    std::size_t k = 1;
    while (buckets_[k].empty()) ++k;
    moving_.swap(buckets_[k]);
    last_ = moving_.front().key;
    for (const Entry& entry : moving_) last_ = std::min(last_, entry.key);
    for (const Entry& entry : moving_) put(entry);
    moving_.clear();
  }

  std::array<std::vector<Entry>, 33> buckets_;  // 0: keys equal to last_, a binary heap
  std::vector<Entry> moving_;
  std::uint32_t last_ = 0;
  std::size_t size_ = 0;
};

}  // namespace atlas
