#include "libatlas/core/granted_threads.h"

#include <algorithm>
#include <cstdlib>
#include <future>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

namespace atlas {
namespace {

// Starts up to `count` threads that live at the same time, and returns how many could be started.
std::size_t startable(std::size_t count) {
  std::vector<std::thread> threads;
  threads.reserve(count);
  std::promise<void> all_started;
  const std::shared_future<void> end = all_started.get_future().share();
  const auto live = [end] {
    // The first allocation of a thread reserves address space for its others, as it does in the
    // threads of oneTBB that come later.
    void* volatile room = std::malloc(1);
    std::free(room);
    end.wait();
  };
  try {
    while (threads.size() < count) threads.emplace_back(live);
  } catch (const std::system_error&) {
  } catch (const std::bad_alloc&) {
  }
  all_started.set_value();
  for (std::thread& thread : threads) thread.join();
  return threads.size();
}

}  // namespace

std::size_t granted_threads(std::size_t wanted) {
  static std::mutex one_at_a_time;
  static std::size_t most = 1;
  const std::lock_guard lock(one_at_a_time);
  if (wanted <= most) return wanted;
  const std::size_t started = startable(wanted - 1);
  // Where not all could start, something is short, which the work itself needs as well.
  const std::size_t granted = 1 + (started < wanted - 1 ? started / 4 : started);
  most = std::max(most, granted);
  return most;
}

}  // namespace atlas
