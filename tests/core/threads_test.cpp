// Loops over threads beyond what parallel_test.cpp and claims_test.cpp hold of them, progress, and
// clocks.
#include <gtest/gtest.h>
#include <pthread.h>
#include <spawn.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <new>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "libatlas/core/claims.h"
#include "libatlas/core/clock.h"
#include "libatlas/core/granted_threads.h"
#include "libatlas/core/parallel.h"
#include "libatlas/core/progress.h"

namespace atlas {
namespace {

Context on_threads(int threads) {
  Context context;
  context.threads = threads;
  return context;
}

// Waits until `condition` holds; returns whether it came to hold within ten seconds.
template <class Condition>
bool comes_true(const Condition& condition) {
  for (int waits = 0; waits < 10000 && !condition(); ++waits)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return condition();
}

TEST(ParallelFor, GrainsMayBeAsLargeAsNumbersAre) {
  constexpr std::size_t kLargest = std::numeric_limits<std::size_t>::max();
  for (const std::size_t grain : {kLargest, kLargest - 3, kLargest / 2 + 1}) {
    for (const int threads : {1, 2}) {
      std::vector<std::pair<std::size_t, std::size_t>> chunks;
      parallel_for(on_threads(threads), 7, grain,
                   [&](std::size_t begin, std::size_t end) { chunks.emplace_back(begin, end); });
      EXPECT_EQ(chunks, (std::vector<std::pair<std::size_t, std::size_t>>{{0, 7}})) << grain;
    }
  }
}

TEST(ParallelFor, RunsOnAsManyThreadsAsAreAskedForBeyondTheCores) {
  const int threads = int(std::thread::hardware_concurrency()) + 2;
  std::atomic<int> running{0}, met{0};
  parallel_for(on_threads(threads), std::size_t(threads), 1, [&](std::size_t, std::size_t) {
    ++running;
    met += comes_true([&] { return running == threads; });
  });
  EXPECT_EQ(met, threads);
}

// The second loop within a chunk shares the threads as the first one does.
TEST(ParallelFor, LoopsOneAfterTheOtherWithinALoopShareTheThreads) {
  std::atomic<int> running{0}, most{0};
  parallel_for(on_threads(2), 8, 1, [&](std::size_t, std::size_t) {
    for (int round = 0; round < 3; ++round) {
      parallel_for(on_threads(6), 30, 1, [&](std::size_t, std::size_t) {
        const int now = ++running;
        std::this_thread::sleep_for(std::chrono::microseconds(200));
        for (int seen = most; seen < now && !most.compare_exchange_weak(seen, now);) continue;
        --running;
      });
    }
  });
  EXPECT_LE(most, 2);
}

// TBB never gives back all of what an arena takes. With one for each loop, this took 40 MB.
TEST(ParallelFor, ManyLoopsTakeNoMoreMemoryThanAFew) {
  const auto loops = [](int count) {
    for (int i = 0; i < count; ++i)
      parallel_for(on_threads(i % 2 ? 0 : 2), 8, 1, [](std::size_t, std::size_t) {});
  };
  loops(100);
  const std::int64_t before = peak_memory();
  loops(6000);
#if defined(__SANITIZE_THREAD__)
  constexpr int kRoom = 32 << 20;  // some 17 MB are the sanitizer's memory of what threads did
#else
  constexpr int kRoom = 8 << 20;
#endif
  EXPECT_LT(peak_memory() - before, kRoom);
}

TEST(ParallelFor, KnowsHowManyThreadsAreAskedFor) {
  EXPECT_EQ(thread_count(on_threads(1)), 1u);
  EXPECT_EQ(thread_count(on_threads(77)), 77u);
  const std::size_t machine = std::thread::hardware_concurrency();
  EXPECT_EQ(thread_count(on_threads(1'000'000)), std::max<std::size_t>(256, machine));
  for (const int threads : {0, -5}) EXPECT_EQ(thread_count(on_threads(threads)), machine);
}

// Stacks larger than memory stand for a limit of threads.
TEST(GrantedThreads, AreThoseThatCanStart) {
  EXPECT_EQ(granted_threads(1), 1u);
  EXPECT_EQ(granted_threads(30), 30u);
  pthread_attr_t before, huge;
  ASSERT_EQ(pthread_getattr_default_np(&before), 0);
  ASSERT_EQ(pthread_attr_init(&huge), 0);
  ASSERT_EQ(pthread_attr_setstacksize(&huge, std::size_t{1} << 46), 0);
  ASSERT_EQ(pthread_setattr_default_np(&huge), 0);
  const std::size_t proved = granted_threads(30), more = granted_threads(5000);
  ASSERT_EQ(pthread_setattr_default_np(&before), 0);
  EXPECT_EQ(proved, 30u);
  EXPECT_GE(more, 30u);
  EXPECT_LT(more, 1000u);
  EXPECT_EQ(granted_threads(more + 1), more + 1);  // the limit is gone
}

// Task 1 runs while task 0 throws, and task 2 waits for task 1.
TEST(ForEachClaim, NothingBeginsAfterATaskHasThrown) {
  std::atomic<int> running{0};
  std::atomic<bool> thrown{false}, begun{false};
  const std::vector<Claims> tasks{{0, 1}, {2, 3}, {2, 2}, {3, 3}};
  const auto body = [&](std::size_t i) {
    if (i >= 2) begun = true;
    if (i >= 2) return;
    ++running;
    EXPECT_TRUE(comes_true([&] { return running == 2; }));
    if (i == 0) {
      thrown = true;
      throw std::bad_alloc();
    }
    EXPECT_TRUE(comes_true([&] { return thrown.load(); }));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));  // lets the exception out
  };
  EXPECT_THROW(for_each_claim(on_threads(2), tasks, body), std::bad_alloc);
  EXPECT_FALSE(begun);
}

TEST(Progress, PartsReportTheirShareOfTheStageAndNeverFall) {
  std::vector<std::pair<std::string, double>> told;
  Context outer = on_threads(3);
  outer.progress = [&](std::string_view stage, double fraction) {
    told.emplace_back(stage, fraction);
  };
  const Context part = part_of_stage(outer, "whole", 0.25, 0.75);
  EXPECT_EQ(part.threads, 3);
  for (const double fraction : {0.0, 0.5, 0.25, 0.5, std::nan(""), 1.5, 2.0, 1.0})
    part.report("part", fraction);
  // What exceeds 1 counts as 1. A second excess may be told again, but does not rise further.
  ASSERT_GE(told.size(), 3u);
  EXPECT_EQ(told[0], (std::pair<std::string, double>("whole", 0.25)));
  EXPECT_EQ(told[1], (std::pair<std::string, double>("whole", 0.5)));
  for (std::size_t i = 2; i < told.size(); ++i)
    EXPECT_EQ(told[i], (std::pair<std::string, double>("whole", 0.75)));
  EXPECT_FALSE(part_of_stage({}, "whole").progress);
}

double process_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

// Reading from a device takes system time and hardly any of the user's.
TEST(Clock, CountsTimeInTheSystem) {
  std::ifstream zeros("/dev/zero", std::ios::binary);
  std::vector<char> block(1 << 20);
  const double begun = cpu_seconds(), own = process_seconds();
  while (process_seconds() - own < 0.2) zeros.read(block.data(), std::streamsize(block.size()));
  EXPECT_NEAR(cpu_seconds() - begun, process_seconds() - own, 0.05);
}

TEST(Clock, PeakMemoryIsWhatTheSystemKeeps) {
  const std::vector<char> large(std::size_t{256} << 20, 'x');
  std::ifstream status("/proc/self/status");
  double kibibytes = 0;
  for (std::string word; status >> word;)
    if (word == "VmHWM:") status >> kibibytes;
  if (kibibytes == 0) GTEST_SKIP() << "the system does not tell";
  EXPECT_NEAR(double(peak_memory()) / (1024 * kibibytes), 1, 0.01) << large.back();
}

// Runs itself once more, as a program of its own.
TEST(Clock, PeakMemoryIsNotThatOfTheCaller) {
  constexpr std::int64_t callers = std::int64_t{512} << 20;
  constexpr const char* mark = "LIBATLAS_TEST_HAS_CALLER";
  if (std::getenv(mark)) {
    EXPECT_LT(peak_memory(), callers / 2);
    return;
  }
  const std::vector<char> large(std::size_t(callers), 'x');
  char program[] = "/proc/self/exe";
  char filter[] = "--gtest_filter=Clock.PeakMemoryIsNotThatOfTheCaller";
  char* arguments[] = {program, filter, nullptr};
  ASSERT_EQ(setenv(mark, "1", 1), 0);
  pid_t child = 0;
  const int error = posix_spawn(&child, program, nullptr, nullptr, arguments, environ);
  unsetenv(mark);
  ASSERT_EQ(error, 0);
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0) << large.back();
}

double told_time = 0;

TEST(Clock, AStopwatchMeasuresFromLapToLap) {
  told_time = 10;
  Stopwatch watch([] { return told_time; });
  told_time = 12.5;
  EXPECT_EQ(watch.lap(), 2.5);
  EXPECT_EQ(watch.lap(), 0);
  told_time = 13;
  EXPECT_EQ(watch.lap(), 0.5);
}

TEST(Clock, MovesForward) {
  const double wall = wall_seconds(), cpu = cpu_seconds();
  volatile double sum = 0;
  while (cpu_seconds() - cpu < 0.02) sum = sum + 1;
  EXPECT_GE(wall_seconds() - wall, 0.005);
  EXPECT_GT(peak_memory(), 1 << 20);
  EXPECT_LT(peak_memory(), std::int64_t{1} << 40);
}

}  // namespace
}  // namespace atlas
