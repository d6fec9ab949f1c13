#include <gtest/gtest.h>
#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <new>
#include <numeric>
#include <random>
#include <set>
#include <thread>

#include "libatlas/core/background.h"
#include "libatlas/core/claims.h"
#include "libatlas/core/clock.h"
#include "libatlas/core/counting_sort.h"
#include "libatlas/core/disjoint_sets.h"
#include "libatlas/core/parallel.h"
#include "libatlas/core/predicates.h"
#include "libatlas/core/rect.h"

namespace atlas {
namespace {

TEST(DisjointSets, JoinInAnyOrderToTheLeastMember) {
  std::mt19937 random(3);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  std::vector<std::uint32_t> least(500);  // spread until nothing changes
  for (std::uint32_t i = 0; i < least.size(); ++i) least[i] = i;
  for (int i = 0; i < 300; ++i) pairs.push_back({random() % 500, random() % 500});
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [a, b] : pairs) {
      changed |= least[a] != least[b];
      least[a] = least[b] = std::min(least[a], least[b]);
    }
  }
  for (int round = 0; round < 3; ++round) {
    std::shuffle(pairs.begin(), pairs.end(), random);
    DisjointSets sets(least.size());
    for (const auto& [a, b] : pairs) sets.join(a, b);
    for (std::uint32_t i = 0; i < least.size(); ++i) EXPECT_EQ(sets.find(i), least[i]);
  }
}

TEST(CountingSort, AgreesWithAStableSort) {
  std::mt19937 random(7);
  for (const std::size_t buckets : {1u, 2u, 7u, 1000u}) {
    for (const std::size_t items : {0u, 1u, 30u, 3000u}) {
      std::vector<std::uint32_t> key(items), order(items);
      for (auto& k : key) k = random() % std::uint32_t(buckets);
      std::iota(order.begin(), order.end(), 0u);
      std::stable_sort(order.begin(), order.end(),
                       [&](std::uint32_t a, std::uint32_t b) { return key[a] < key[b]; });
      const Buckets sorted =
          sort_into_buckets(items, buckets, [&](std::size_t i) { return key[i]; });
      EXPECT_EQ(sorted.items, order);
      ASSERT_EQ(sorted.size(), buckets);
      std::size_t seen = 0;
      for (std::uint32_t b = 0; b < buckets; ++b) {
        EXPECT_EQ(sorted.begin[b], seen);
        for (const std::uint32_t i : sorted[b]) EXPECT_EQ(key[i], b);
        seen += sorted[b].size();
      }
      EXPECT_EQ(seen, items);
    }
  }
  EXPECT_EQ(sort_into_buckets(0, 0, [](std::size_t) { return 0u; }).size(), 0u);
}

TEST(Background, RunsAtMostSoManyTasksAtOnceAndAllOfThem) {
  for (const std::size_t at_once : {0u, 1u, 3u}) {
    std::atomic<std::size_t> running = 0, most = 0, done = 0;
    Background background(at_once);
    for (int i = 0; i < 20; ++i) {
      ASSERT_TRUE(background
                      .add([&] {
                        const std::size_t now = ++running;
                        for (std::size_t seen = most; now > seen;) {
                          if (most.compare_exchange_weak(seen, now)) break;
                        }
                        std::this_thread::sleep_for(std::chrono::milliseconds(1));
                        --running;
                        ++done;
                        return Status();
                      })
                      .ok());
      if (at_once == 0) {
        EXPECT_EQ(done, std::size_t(i) + 1);
      }
    }
    EXPECT_TRUE(background.finish().ok());
    EXPECT_EQ(done, 20u);
    EXPECT_LE(most, std::max<std::size_t>(at_once, 1));
  }
}

// No thread can start either where a container's limit of processes is reached. Here threads ask
// for stacks that are larger than memory.
TEST(Background, RunsTasksByItselfWhereNoThreadCanStart) {
  pthread_attr_t before, huge;
  ASSERT_EQ(pthread_getattr_default_np(&before), 0);
  ASSERT_EQ(pthread_attr_init(&huge), 0);
  ASSERT_EQ(pthread_attr_setstacksize(&huge, std::size_t{1} << 46), 0);
  ASSERT_EQ(pthread_setattr_default_np(&huge), 0);
  std::vector<int> order;
  bool thrown = false;
  Status status;
  {
    EXPECT_THROW(std::thread([] {}).join(), std::system_error);
    Background background(2);
    for (int i = 0; i < 5; ++i)
      (void)background.add([&order, i] {
        order.push_back(i);
        return i < 3 ? Status() : Status(ErrorCode::io, std::to_string(i));
      });
    status = background.finish();
    Background throwing(2);
    (void)throwing.add([]() -> Status { throw std::bad_alloc(); });
    try {
      (void)throwing.finish();
    } catch (const std::bad_alloc&) {
      thrown = true;
    }
  }
  ASSERT_EQ(pthread_setattr_default_np(&before), 0);
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2, 3, 4}));
  EXPECT_EQ(status.message(), "3");
  EXPECT_TRUE(thrown);
}

TEST(Background, BeginsNothingAfterAFailureAndTellsTheFirst) {
  for (const std::size_t at_once : {0u, 1u, 2u}) {
    std::atomic<int> begun = 0;
    Background background(at_once);
    const auto task = [&](int i) {
      return [&begun, i] {
        ++begun;
        return i < 3 ? Status() : Status(ErrorCode::io, "task " + std::to_string(i));
      };
    };
    for (int i = 0; i < 20; ++i) {
      if (!background.add(task(i)).ok()) break;
    }
    EXPECT_EQ(background.finish().message(), "task 3") << at_once;
    EXPECT_LE(begun, 4 + int(at_once));
    EXPECT_FALSE(background.add(task(0)).ok());
  }
  Background throwing(2);
  ASSERT_TRUE(throwing.add([]() -> Status { throw std::bad_alloc(); }).ok());
  EXPECT_THROW(static_cast<void>(throwing.finish()), std::bad_alloc);
}

// The time of tasks on other threads counts as the caller's once they are done.
TEST(Background, CountsAsTheTimeOfItsUser) {
  for (const std::size_t at_once : {0u, 1u, 3u}) {
    const double begun = own_cpu_seconds();
    Background background(at_once);
    for (int i = 0; i < 6; ++i) {
      ASSERT_TRUE(background
                      .add([] {
                        volatile double sum = 0;
                        for (const double start = thread_cpu_seconds();
                             thread_cpu_seconds() - start < 0.01;)
                          sum = sum + 1;
                        return Status();
                      })
                      .ok());
    }
    ASSERT_TRUE(background.finish().ok());
    const double spent = own_cpu_seconds() - begun;
    EXPECT_GE(spent, 0.06) << at_once;
    EXPECT_LT(spent, 0.06 + 0.03) << at_once;
  }
}

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

// Integers that are small enough for exact 64-bit determinants give the expected sign. The
// predicate gets them moved by a power of two, so that doubles still represent them but naive
// products round.
TEST(Predicates, OrientationIsExact) {
  std::mt19937_64 random(4);
  std::uniform_int_distribution<std::int64_t> small(-3, 3);
  const double moved = std::exp2(51);
  for (int i = 0; i < 20000; ++i) {
    const std::int64_t c[6] = {small(random), small(random), small(random),
                               small(random), small(random), small(random)};
    const std::int64_t det = (c[2] - c[0]) * (c[5] - c[1]) - (c[3] - c[1]) * (c[4] - c[0]);
    const auto at = [&](int k) { return Vec2d{moved + double(c[k]), moved + double(c[k + 1])}; };
    EXPECT_EQ(orientation(at(0), at(2), at(4)), (det > 0) - (det < 0));
  }
  const double e = std::exp2(-53);
  EXPECT_EQ(orientation({0, 0}, {1, 1}, {0.5, 0.5 + e}), 1);
  EXPECT_EQ(orientation({0, 0}, {1, 1}, {0.5, 0.5}), 0);
  EXPECT_EQ(orientation({1e-300, 0}, {1, 1e300}, {1e-300, 0}), 0);
}

TEST(Predicates, SegmentsCross) {
  EXPECT_TRUE(segments_cross({0, 0}, {2, 2}, {0, 2}, {2, 0}));
  EXPECT_FALSE(segments_cross({0, 0}, {1, 1}, {2, 0}, {3, 5}));
  EXPECT_FALSE(segments_cross({0, 0}, {1, 1}, {1, 1}, {2, 0}));  // a shared end
  EXPECT_TRUE(segments_cross({0, 0}, {3, 0}, {1, 0}, {5, 0}));   // an overlap along a part
  EXPECT_FALSE(segments_cross({0, 0}, {1, 0}, {1, 0}, {2, 0}));  // end to end on one line
  EXPECT_FALSE(segments_cross({0, 0}, {1, 0}, {2, 0}, {3, 0}));
}

// Returns whether the segments share a point that is not an end of both, or are equal. Computed
// from the signs of integers, independently of the method of the predicate.
bool cross_by_integers(const int (&c)[8]) {
  const auto side = [&](int a, int b, int p) {
    const int det = (c[b] - c[a]) * (c[p + 1] - c[a + 1]) - (c[b + 1] - c[a + 1]) * (c[p] - c[a]);
    return (det > 0) - (det < 0);
  };
  const auto inside = [&](int a, int b, int p) {  // strictly between a and b, on their line
    const int along = (c[p] - c[a]) * (c[b] - c[a]) + (c[p + 1] - c[a + 1]) * (c[b + 1] - c[a + 1]);
    const int square =
        (c[b] - c[a]) * (c[b] - c[a]) + (c[b + 1] - c[a + 1]) * (c[b + 1] - c[a + 1]);
    return side(a, b, p) == 0 && along > 0 && along < square;
  };
  const auto same = [&](int a, int b) { return c[a] == c[b] && c[a + 1] == c[b + 1]; };
  if (side(0, 2, 4) * side(0, 2, 6) < 0 && side(4, 6, 0) * side(4, 6, 2) < 0) return true;
  if (inside(0, 2, 4) || inside(0, 2, 6) || inside(4, 6, 0) || inside(4, 6, 2)) return true;
  const bool twice = (same(0, 4) && same(2, 6)) || (same(0, 6) && same(2, 4));
  return twice && !same(0, 2);
}

// All pairs of segments on a small grid: ends on ends, ends inside, collinear ones, points.
TEST(Predicates, SegmentsCrossAsIntegersSay) {
  constexpr int kSide = 4;
  const double moved = std::exp2(50);
  int crossing = 0;
  for (int code = 0; code < 1 << 16; ++code) {
    int c[8];
    for (int k = 0; k < 8; ++k) c[k] = code >> (2 * k) & (kSide - 1);
    const auto at = [&](int k) { return Vec2d{moved + double(c[k]), double(c[k + 1]) - moved}; };
    const bool expected = cross_by_integers(c);
    ASSERT_EQ(segments_cross(at(0), at(2), at(4), at(6)), expected) << code;
    crossing += expected;
  }
  EXPECT_GT(crossing, 1000);
}

TEST(Clock, MovesForward) {
  const double wall = wall_seconds(), cpu = cpu_seconds();
  volatile double sum = 0;
  while (cpu_seconds() - cpu < 0.02) sum = sum + 1;
  EXPECT_GE(wall_seconds() - wall, 0.005);
  EXPECT_GT(peak_memory(), 1 << 20);
  EXPECT_LT(peak_memory(), std::int64_t{1} << 40);
}

TEST(Rect, Edges) {
  const Rect r{-2, 3, 65536, 65536};
  EXPECT_EQ(r.right(), 65534);
  EXPECT_EQ(r.top(), 65539);
  EXPECT_EQ(r.area(), std::int64_t{1} << 32);
}

}  // namespace
}  // namespace atlas
