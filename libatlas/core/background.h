// Internal: Background, which runs tasks beside the caller's own work, such as writing a page while
// the next one is baked.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <future>

#include "libatlas/core/status.h"

namespace atlas {

// Runs tasks in the order in which they are added, each on a thread of its own, or on the caller's
// thread if the system starts no more threads. An object is for one thread. The CPU time of a task
// is added to that thread's own_cpu_seconds() once the task has been waited for.
class Background {
 public:
  // At most `at_once` tasks run at the same time. If it is 0, add() runs each task before it
  // returns.
  explicit Background(std::size_t at_once) : at_once_(at_once) {}
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;
  ~Background() = default;  // waits for the running tasks

  // If `at_once` tasks are running, waits for the oldest one first. Once a task that failed has
  // been waited for, no further task begins, and the failure is returned: the first one in the
  // order of adding. Exceptions of a task leave this function or finish().
  Status add(std::function<Status()> task);

  // Waits for all tasks. Returns the first failure in the order of adding.
  Status finish();

 private:
  struct Done {
    Status status;
    double cpu_seconds = 0;
  };
  static std::future<Done> start(std::function<Status()> task);
  void wait_for_oldest();

  std::size_t at_once_;
  Status status_;
  std::deque<std::future<Done>> under_way_;
};

}  // namespace atlas
