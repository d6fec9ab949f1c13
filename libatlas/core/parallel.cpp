#include "libatlas/core/parallel.h"

#include <algorithm>
#include <atomic>
#include <thread>

#include "libatlas/core/clock.h"
#include "libatlas/core/run_chunks.h"

namespace atlas {
namespace {

// CPU time that this thread's loops and background tasks have used on other threads.
thread_local double lent_seconds = 0;
thread_local bool in_chunk = false;  // whether this thread runs a chunk of a loop

// Lives while a thread runs one chunk. If that is not the loop's own thread, its CPU time is added
// to `lent`.
class ChunkOnThread {
 public:
  explicit ChunkOnThread(std::atomic<double>& lent, std::thread::id owner)
      : lent_(lent), away_(std::this_thread::get_id() != owner), nested_(in_chunk) {
    in_chunk = true;
    if (away_) begun_ = own_cpu_seconds();
  }
  ~ChunkOnThread() {
    in_chunk = nested_;
    if (!away_) return;
    const double used = own_cpu_seconds() - begun_;
    for (double lent = lent_; !lent_.compare_exchange_weak(lent, lent + used);) {
    }
  }
  ChunkOnThread(const ChunkOnThread&) = delete;
  ChunkOnThread& operator=(const ChunkOnThread&) = delete;

 private:
  std::atomic<double>& lent_;
  bool away_, nested_;
  double begun_ = 0;
};

}  // namespace

std::size_t thread_count(const Context& context) {
  const std::size_t machine = std::max(1u, std::thread::hardware_concurrency());
  if (context.threads <= 0) return machine;
  // Thousands of threads take seconds to begin, and most would have nothing to do.
  constexpr std::size_t kMost = 256;
  return std::min(std::size_t(context.threads), std::max(kMost, machine));
}

double own_cpu_seconds() {
  return thread_cpu_seconds() + lent_seconds;
}

void add_own_cpu_seconds(double seconds) {
  lent_seconds += seconds;
}

void release_threads() {
  release_loop_threads();
}

void parallel_for(const Context& context, std::size_t n, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body) {
  grain = std::max<std::size_t>(grain, 1);
  const std::size_t chunks = n / grain + (n % grain != 0);
  const auto run_chunk = [&](std::size_t chunk) {
    const std::size_t begin = chunk * grain;
    if (!context.cancelled()) body(begin, begin + std::min(n - begin, grain));
  };
  if (chunks <= 1 || context.threads == 1) {
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) run_chunk(chunk);
    return;
  }
  std::atomic<double> lent{0};
  run_chunks(thread_count(context), in_chunk, chunks,
             [&, owner = std::this_thread::get_id()](std::size_t chunk) {
               const ChunkOnThread on_thread(lent, owner);
               run_chunk(chunk);
             });
  lent_seconds += lent;
}

}  // namespace atlas
