#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <map>
#include <optional>

#include "libatlas/core/granted_threads.h"
#include "libatlas/core/run_chunks.h"

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

void run_chunks(std::size_t threads, bool within, std::size_t chunks,
                const std::function<void(std::size_t)>& run) {
  HandOver hand_over;
  const auto run_in_thread = [&](std::size_t chunk) {
    HandOver::chunk_begins();
    run(chunk);
    hand_over.chunk_ends();
  };
  const Task<decltype(run_in_thread)> task{&run_in_thread};
  const auto run_all = [&] {
    tbb::parallel_for(std::size_t{0}, chunks, task, tbb::simple_partitioner());
  };
  HandOver::loop_begins();
  if (within) {
    tbb::this_task_arena::isolate(run_all);
  } else {
    run_in_arena(int(threads), run_all);
  }
}

void release_loop_threads() {
  own_arenas().clear();
}

}  // namespace atlas
