// Internal: a priority queue for small integer keys that never fall below the last key taken.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory_resource>
#include <vector>

namespace atlas {

// A ring of buckets, one per key (Dial 1969, "Algorithm 360: Shortest-path forest with topological
// ordering"). A bit field marks the buckets in use. Entries more than a ring ahead wait in a list
// until the ring is empty. Each entry is written once and read once, where a heap would move it
// repeatedly. Entry has a member `key`. Equal keys come out in no particular order, but always in
// the same order for the same pushes.
template <class Entry>
class RingQueue {
 public:
  bool empty() const { return size_ == 0; }

  // Allows any key again. Precondition: empty.
  void restart() { base_ = next_ = 0; }

  // Precondition: the key is not below that of the last entry taken since the last restart.
  void push(const Entry& entry) {
    ++size_;
    if (entry.key - base_ < kBuckets) {
      put(entry);
    } else {
      far_.push_back(entry);
    }
  }

  // Returns the entry that pop() will return after `count` others, if it is in the current bucket;
  // else nullptr. Callers use it for prefetching.
  const Entry* ahead(std::size_t count) const {
    const auto& bucket = buckets_[next_];
    return count < bucket.size() ? &bucket[bucket.size() - 1 - count] : nullptr;
  }

  // Removes and returns an entry with the smallest key. Precondition: not empty.
  Entry pop() {
    std::uint32_t word = next_ / 64;
    if (!used_[word]) {
      while (word < used_.size() && !used_[word]) ++word;
      if (word == used_.size()) word = refill();
    }
    next_ = 64 * word + static_cast<std::uint32_t>(std::countr_zero(used_[word]));
    auto& bucket = buckets_[next_];
    const Entry entry = bucket.back();
    bucket.pop_back();
    if (bucket.empty()) used_[word] &= ~(std::uint64_t{1} << (next_ % 64));
    --size_;
    return entry;
  }

 private:
  static constexpr std::uint32_t kBuckets = 4096;

  void put(const Entry& entry) {
    const std::uint32_t place = entry.key - base_;
    buckets_[place].push_back(entry);
    used_[place / 64] |= std::uint64_t{1} << (place % 64);
  }

  // Moves the waiting entries into the ring. Returns the first word in use, which is 0.
  std::uint32_t refill() {
    moving_.swap(far_);
    base_ = moving_.front().key;
    for (const Entry& entry : moving_) base_ = std::min(base_, entry.key);
    size_ -= moving_.size();
    for (const Entry& entry : moving_) push(entry);
    moving_.clear();
    return 0;
  }

  std::pmr::monotonic_buffer_resource memory_;  // thousands of small buckets, freed together
  std::pmr::vector<std::pmr::vector<Entry>> buckets_{kBuckets, &memory_};
  std::array<std::uint64_t, kBuckets / 64> used_{};
  std::vector<Entry> far_, moving_;
  std::uint32_t base_ = 0, next_ = 0;  // the first bucket's key; where to look first
  std::size_t size_ = 0;
};

}  // namespace atlas
