// Compares the queue of integer keys with std::multimap.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <random>
#include <vector>

#include "libatlas/charts/cells/ring_queue.h"

namespace atlas {
namespace {

struct Entry {
  std::uint32_t key, number;
};

// Applies every operation to both and expects equal results.
class Twins {
 public:
  void push(std::uint32_t key) {
    queue_.push({key, number_});
    expected_.emplace(key, number_++);
    EXPECT_FALSE(queue_.empty());
  }

  // Returns the key, which is the smallest of all.
  std::uint32_t pop() {
    const Entry entry = queue_.pop();
    EXPECT_EQ(entry.key, expected_.begin()->first);
    const auto [begin, end] = expected_.equal_range(entry.key);
    const auto at =
        std::find_if(begin, end, [&](const auto& e) { return e.second == entry.number; });
    EXPECT_NE(at, end) << "taken twice, or never given";
    if (at != end) expected_.erase(at);
    EXPECT_EQ(queue_.empty(), expected_.empty());
    return entry.key;
  }

  // Pushes and pops at random, with keys up to `reach` ahead of the last one popped.
  void mix(std::uint32_t start, std::uint32_t reach, int steps, std::mt19937& random) {
    std::uint32_t last = start;
    for (int i = 0; i < steps; ++i) {
      const bool pushes = empty() || random() % 100 < (i < steps / 2 ? 60u : 40u);
      if (pushes)
        push(last + (random() % 4 == 0 ? 0 : random() % (reach + 1)));
      else
        last = pop();
    }
    while (!empty()) pop();
  }

  void restart() { queue_.restart(); }
  bool empty() const { return expected_.empty(); }
  RingQueue<Entry>& queue() { return queue_; }

 private:
  RingQueue<Entry> queue_;
  std::multimap<std::uint32_t, std::uint32_t> expected_;
  std::uint32_t number_ = 0;
};

TEST(RingQueue, TakesTheSmallestKeyHoweverFarTheNextOnesLie) {
  std::mt19937 random(1);
  // The keys cover few values, several words of the ring, about the size of the ring, and far more.
  for (const std::uint32_t reach : {0u, 3u, 200u, 4095u, 4096u, 4097u, 20000u, 50000000u}) {
    Twins twins;
    for (int round = 0; round < 5; ++round) {
      twins.restart();
      twins.mix(0, reach, 4000, random);
    }
  }
}

TEST(RingQueue, StartsAgainFromAnyKey) {
  std::mt19937 random(2);
  Twins twins;
  for (const std::uint32_t start : {4000000000u, 0u, 1000000u, 5u, 4095u, 4096u}) {
    twins.restart();
    twins.mix(start, 6000, 3000, random);
  }
}

TEST(RingQueue, TakesTheLargestKeys) {
  Twins twins;
  for (const std::uint32_t key : {0xffffffffu, 0u, 0xfffffffeu, 4096u, 0xffffffffu}) {
    twins.push(key);
  }
  std::vector<std::uint32_t> keys;
  while (!twins.empty()) keys.push_back(twins.pop());
  EXPECT_EQ(keys, (std::vector<std::uint32_t>{0, 4096, 0xfffffffe, 0xffffffff, 0xffffffff}));
}

TEST(RingQueue, SaysAheadWhatItWillReturn) {
  RingQueue<Entry> queue;
  EXPECT_EQ(queue.ahead(0), nullptr);
  for (std::uint32_t i = 0; i < 5; ++i) queue.push({70, i});
  queue.push({90, 5});
  queue.push({70, 6});
  queue.pop();
  std::vector<std::uint32_t> said, taken;
  for (std::size_t count = 0; queue.ahead(count); ++count) {
    said.push_back(queue.ahead(count)->number);
  }
  EXPECT_EQ(said.size(), 5u);
  while (taken.size() < said.size()) taken.push_back(queue.pop().number);
  EXPECT_EQ(said, taken);
  EXPECT_EQ(queue.ahead(0), nullptr);
  EXPECT_EQ(queue.pop().number, 5u);
  EXPECT_TRUE(queue.empty());
}

TEST(RingQueue, SameOrderForTheSamePushes) {
  const auto order = [] {
    RingQueue<Entry> queue;
    std::mt19937 random(4);
    for (std::uint32_t i = 0; i < 2000; ++i) queue.push({std::uint32_t(random() % 9000), i});
    std::vector<std::uint32_t> numbers;
    while (!queue.empty()) numbers.push_back(queue.pop().number);
    return numbers;
  };
  EXPECT_EQ(order(), order());
}

}  // namespace
}  // namespace atlas
