#include "libatlas/core/claims.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <new>
#include <random>
#include <thread>
#include <vector>

namespace atlas {
namespace {

TEST(ForEachClaim, IsASerialLoopForWhatTasksShare) {
  std::mt19937 random(11);
  for (const std::uint32_t things : {2u, 5u, 40u}) {
    std::vector<Claims> tasks;
    std::uniform_int_distribution<std::uint32_t> thing(0, things - 1);
    for (int i = 0; i < 300; ++i) tasks.push_back({thing(random), thing(random)});
    std::vector<std::uint64_t> expected;
    for (const int threads : {1, 2, 5, 0}) {
      Context context;
      context.threads = threads;
      std::vector<std::uint64_t> state(things, 1);
      for_each_claim(context, tasks, [&](std::size_t i) {  // no two of these operations commute
        auto& [a, b] = tasks[i];
        state[a] = 3 * state[a] + state[b] + i;
        std::this_thread::sleep_for(std::chrono::microseconds(20));
        state[b] = 5 * state[b] + state[a];
      });
      if (threads == 1) expected = state;
      EXPECT_EQ(state, expected) << threads << " threads, " << things << " things";
    }
  }
}

TEST(ForEachClaim, TasksThatShareNothingRunAtOnce) {
  Context context;
  context.threads = 2;
  std::atomic<int> running{0};
  bool met[2] = {false, false};
  const std::vector<Claims> tasks{{0, 1}, {2, 3}};
  for_each_claim(context, tasks, [&](std::size_t i) {
    ++running;
    for (int waits = 0; running < 2 && waits < 10000; ++waits) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    met[i] = running == 2;
  });
  EXPECT_TRUE(met[0] && met[1]);
}

TEST(ForEachClaim, EndsWhenCancelledOrThrownAt) {
  for (const int threads : {1, 3}) {
    std::atomic<bool> cancel{false};
    Context context;
    context.threads = threads;
    const std::vector<Claims> tasks(100, Claims{0, 0});  // forces them to run one after the other
    const auto fail = [](std::size_t i) {
      if (i == 7) throw std::bad_alloc();
    };
    EXPECT_THROW(for_each_claim(context, tasks, fail), std::bad_alloc);
    context.cancel = &cancel;
    int done = 0;
    for_each_claim(context, tasks, [&](std::size_t i) {
      ++done;
      if (i == 7) cancel = true;
    });
    EXPECT_EQ(done, 8);
  }
}

}  // namespace
}  // namespace atlas
