#include "libatlas/core/background.h"

#include <gtest/gtest.h>
#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <new>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "libatlas/core/clock.h"
#include "libatlas/core/parallel.h"

namespace atlas {
namespace {

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

}  // namespace
}  // namespace atlas
