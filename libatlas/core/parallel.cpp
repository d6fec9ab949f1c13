#include "libatlas/core/parallel.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <optional>
#include <thread>

#include "libatlas/core/clock.h"
#include "libatlas/core/granted_threads.h"

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#define ATLAS_UNSEEN __attribute__((no_sanitize("thread")))
#else
#define ATLAS_UNSEEN
#endif

namespace atlas {
namespace {

// Tells ThreadSanitizer how TBB synchronises threads, which it cannot see inside TBB's library:
// every chunk sees what happened before the loop, and the code after the loop sees what the chunks
// did. Chunks see nothing of each other.
class HandOver {
 public:
#ifdef __SANITIZE_THREAD__
  static void loop_begins() {
    __tsan_release(&begun_);
  }
  ~HandOver() {
    __tsan_acquire(&done_);
  }
  static void chunk_begins() {
    __tsan_acquire(&begun_);
  }
  void chunk_ends() {
    __tsan_release(&done_);
  }

 private:
  // All loops share it, because a chunk may not even read the address of its own loop before this.
  inline static char begun_ = 0;
  char done_ = 0;
#else
  static void loop_begins() {}
  static void chunk_begins() {}
  void chunk_ends() {}
#endif
};

// The function object that TBB copies between tasks on any thread. Reading it is part of TBB's
// synchronisation, so ThreadSanitizer does not check it.
template <class Run>
struct Task {
  const Run* run;
  ATLAS_UNSEEN void operator()(std::size_t chunk) const { (*run)(chunk); }
};

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
    if (away_) lent_.fetch_add(own_cpu_seconds() - begun_, std::memory_order_relaxed);
  }
  ChunkOnThread(const ChunkOnThread&) = delete;
  ChunkOnThread& operator=(const ChunkOnThread&) = delete;

 private:
  std::atomic<double>& lent_;
  bool away_, nested_;
  double begun_ = 0;
};

// Threads of TBB for the loops of one thread.
struct Arena {
  explicit Arena(int wanted)
      : size(int(granted_threads(std::size_t(wanted)))), few(size < wanted), threads(size) {}
  int size;
  bool few;  // whether the system grants fewer threads than are wanted
  tbb::task_arena threads;
};

// Returns this thread's arenas by the number of threads that are wanted. It keeps them for its
// later loops. An arena for each loop would cost memory and time that TBB does not give back:
// twelve thousand loops took 2.3 s instead of 0.01.
std::map<int, Arena>& own_arenas() {
  thread_local std::map<int, Arena> arenas;
  return arenas;
}

// Calls `run` in an arena of so many threads.
template <class Run>
void run_in_arena(int wanted, const Run& run) {
  Arena& arena = own_arenas().try_emplace(wanted, wanted).first->second;
  // A context may ask for more threads than there are cores (tests do so to show that results do
  // not depend on the number). TBB grants them only with this limit. Nor may it start more threads
  // for others than the system grants.
  std::optional<tbb::global_control> limit;
  if (arena.few || arena.size > tbb::info::default_concurrency()) {
    limit.emplace(tbb::global_control::max_allowed_parallelism, std::size_t(arena.size));
  }
  arena.threads.execute(run);
}

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
  own_arenas().clear();
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
  HandOver hand_over;
  std::atomic<double> lent{0};
  const auto run_in_thread = [&, owner = std::this_thread::get_id()](std::size_t chunk) {
    HandOver::chunk_begins();
    {
      const ChunkOnThread on_thread(lent, owner);
      run_chunk(chunk);
    }
    hand_over.chunk_ends();
  };
  const Task<decltype(run_in_thread)> task{&run_in_thread};
  const auto run_all = [&] {
    tbb::parallel_for(std::size_t{0}, chunks, task, tbb::simple_partitioner());
  };
  HandOver::loop_begins();
  if (in_chunk) {
    tbb::this_task_arena::isolate(run_all);
  } else {
    run_in_arena(
        context.threads > 0 ? int(thread_count(context)) : tbb::info::default_concurrency(),
        run_all);
  }
  lent_seconds += lent;
}

}  // namespace atlas
