#include "libatlas/core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "libatlas/core/clock.h"

namespace atlas {
namespace {

TEST(ParallelFor, CoversEachIndexOnceInTheSameChunks) {
  for (const std::size_t n : {0u, 1u, 7u, 64u, 1000u}) {
    for (const std::size_t grain : {0u, 1u, 3u, 64u, 5000u}) {
      std::set<std::pair<std::size_t, std::size_t>> expected;
      for (const int threads : {1, 2, 0}) {
        Context context;
        context.threads = threads;
        std::vector<std::atomic<int>> touched(n);
        std::set<std::pair<std::size_t, std::size_t>> chunks;
        std::mutex mutex;
        parallel_for(context, n, grain, [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) ++touched[i];
          const std::lock_guard lock(mutex);
          chunks.emplace(begin, end);
        });
        for (const auto& count : touched) ASSERT_EQ(count, 1);
        if (threads == 1) expected = chunks;
        EXPECT_EQ(chunks, expected);
      }
    }
  }
}

TEST(ParallelFor, LoopsWithinLoopsShareTheThreads) {
  for (const int threads : {1, 2, 3}) {
    Context context;
    context.threads = threads;
    std::vector<std::atomic<int>> touched(40 * 50);
    std::atomic<int> running{0}, most{0};
    Context inner;
    inner.threads = 6;  // more than there are
    parallel_for(context, 40, 1, [&](std::size_t outer, std::size_t) {
      parallel_for(threads == 1 ? context : inner, 50, 3, [&](std::size_t begin, std::size_t end) {
        const int now = ++running;
        // Gives other threads time to come.
        std::this_thread::sleep_for(std::chrono::microseconds(200));
        for (int seen = most; seen < now && !most.compare_exchange_weak(seen, now);) continue;
        for (std::size_t i = begin; i < end; ++i) ++touched[50 * outer + i];
        --running;
      });
    });
    for (const auto& count : touched) ASSERT_EQ(count, 1);
    EXPECT_LE(most, threads);
  }
}

TEST(ParallelFor, ACallKnowsTheTimeOfItsLoopsAndNoOther) {
  const auto work = [](double seconds) {
    volatile double sum = 0;
    for (const double begun = thread_cpu_seconds(); thread_cpu_seconds() - begun < seconds;)
      sum = sum + 1;
  };
  std::atomic<bool> done{false};
  std::thread other([&] {
    while (!done) work(0.001);
  });
  for (const int threads : {1, 3}) {
    Context context;
    context.threads = threads;
    const double begun = own_cpu_seconds();
    parallel_for(context, 6, 1, [&](std::size_t, std::size_t) {
      parallel_for(context, 5, 1, [&](std::size_t, std::size_t) { work(0.002); });
    });
    const double spent = own_cpu_seconds() - begun;
    EXPECT_GE(spent, 30 * 0.002);
    EXPECT_LT(spent, 30 * 0.002 + 0.03);
  }
  done = true;
  other.join();
}

TEST(ParallelFor, SkipsWhatIsLeftOnceCancelled) {
  std::atomic<bool> cancel{false};
  Context context;
  context.threads = 1;
  context.cancel = &cancel;
  int done = 0;
  parallel_for(context, 100, 1, [&](std::size_t begin, std::size_t) {
    ++done;
    if (begin == 9) cancel = true;
  });
  EXPECT_EQ(done, 10);
}

}  // namespace
}  // namespace atlas
