#include "libatlas/core/granted_threads.h"

#include <algorithm>
#include <cstdint>
#include <future>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

#include "libatlas/core/process.h"

namespace atlas {
namespace {

// Returns how many threads may start by the limit of the process's addresses. A thread takes some
// of them for its stack, and the C library reserves 64 MiB for its allocations. Half of the
// addresses remain for the work.
std::size_t addressable(std::size_t count) {
  constexpr std::uint64_t kThread = std::uint64_t{72} << 20;
  return std::size_t(std::min<std::uint64_t>(count, free_address_space() / 2 / kThread));
}

}  // namespace

std::size_t startable_threads(std::size_t count) {
  std::vector<std::thread> threads;
  threads.reserve(count);
  std::promise<void> all_started;
  const std::shared_future<void> end = all_started.get_future().share();
  try {
    while (threads.size() < count) threads.emplace_back([end] { end.wait(); });
  } catch (const std::system_error&) {
  } catch (const std::bad_alloc&) {
  }
  all_started.set_value();
  for (std::thread& thread : threads) thread.join();
  return threads.size();
}

std::size_t granted_threads(std::size_t wanted) {
  static std::mutex one_at_a_time;
  static std::size_t most = 1;
  const std::lock_guard lock(one_at_a_time);
  if (wanted <= most) return wanted;
  const std::size_t others = addressable(wanted - 1), started = startable_threads(others);
  // Where not all can start, some remain for others.
  most = std::max(most, 1 + (started < others ? started / 2 : started));
  return std::min(most, wanted);
}

}  // namespace atlas
