// Internal: tasks done beside the caller's own work, such as writing a page while the next one is
// baked.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <future>

#include "libatlas/core/status.h"

namespace atlas {

// Used by one thread. Tasks begin in the order of asking, each on a thread of its own, or on the
// caller's thread if the system starts no more. What they take counts as the user's
// (own_cpu_seconds) once they have been waited for.
class Background {
 public:
  // At most `at_once` tasks are under way; 0: each is done before add() returns.
  explicit Background(std::size_t at_once) : at_once_(at_once) {}
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;
  ~Background() = default;  // waits for what is under way

  // While `at_once` tasks are under way, waits for the oldest first. After a failure nothing is
  // begun any more: gives back the first one, in the order of asking. Exceptions of a task leave
  // from here or from finish().
  Status add(std::function<Status()> task);

  // Waits for all; the first failure in the order of asking.
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
