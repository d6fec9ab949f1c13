// Internal: counting sort, which sorts by small integer keys in linear time: for example triangles
// by vertex, edges by their lower end, runs by row.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atlas {

// Sorts the items 0, 1, ..., items - 1 by bucket_of(i), which must be less than `buckets`; items of
// one bucket keep their order. Calls place(i, at) for each item in turn, where `at` is its position
// in the sorted order. Returns the position at which each bucket begins, followed by the end of the
// last one. Calls bucket_of twice for each item.
template <class BucketOf, class Place>
std::vector<std::uint32_t> counting_sort(std::size_t items, std::size_t buckets,
                                         const BucketOf& bucket_of, const Place& place) {
  // begin[b + 2] first counts the items of bucket b. After the sums, begin[b + 1] is where b
  // begins, and each placed item moves it on, up to the end of b.
  std::vector<std::uint32_t> begin(buckets + 2, 0);
  for (std::size_t i = 0; i < items; ++i) ++begin[bucket_of(i) + 2];
  for (std::size_t b = 2; b < begin.size(); ++b) begin[b] += begin[b - 1];
  for (std::size_t i = 0; i < items; ++i) place(i, begin[bucket_of(i) + 1]++);
  begin.pop_back();
  return begin;
}

// The items 0, 1, ... sorted into buckets; within a bucket they ascend.
struct Buckets {
  std::vector<std::uint32_t> begin;  // where each bucket begins in `items`, and the end
  std::vector<std::uint32_t> items;

  std::size_t size() const { return begin.size() - 1; }
  std::span<const std::uint32_t> operator[](std::size_t bucket) const {
    return {items.data() + begin[bucket], items.data() + begin[bucket + 1]};
  }
};

template <class BucketOf>
Buckets sort_into_buckets(std::size_t items, std::size_t buckets, const BucketOf& bucket_of) {
  Buckets sorted;
  sorted.items.resize(items);
  sorted.begin = counting_sort(items, buckets, bucket_of, [&](std::size_t i, std::uint32_t at) {
    sorted.items[at] = static_cast<std::uint32_t>(i);
  });
  return sorted;
}

}  // namespace atlas
