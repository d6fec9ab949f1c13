// Parallel loops (by oneTBB where it was found, else by threads of our own) whose results do not
// depend on the number of threads: `grain` alone determines how the range is divided into chunks,
// and chunks write to disjoint outputs.
#pragma once

#include <cstddef>
#include <functional>

#include "libatlas/core/context.h"

namespace atlas {

// Calls body(begin, end) for chunks of at most `grain` (>= 1) indices that together cover [0, n),
// on up to context.threads threads. Once context.cancelled(), chunks that have not begun are
// skipped, so the caller must check context.cancelled() afterwards. A loop inside a chunk of
// another loop shares its threads.
void parallel_for(const Context& context, std::size_t n, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

// Gives up what the calling thread keeps for its loops: threads of our own end, and tbb::finalize()
// can end TBB's. For programs that fork. Must not be called within a loop. Later loops begin anew.
void release_threads();

// Returns the number of threads that a context gets, at least 1: the machine's number if the
// context leaves it open, and at most 256 or the machine's number if that is larger.
std::size_t thread_count(const Context& context);

// Returns the CPU time of the calling thread, plus that which its loops and background tasks
// (background.h) have used on other threads, in seconds. Differences of it are the CPU time that a
// call took, whatever else the process did meanwhile.
double own_cpu_seconds();

// Adds CPU time that another thread has spent for the calling thread to own_cpu_seconds() of the
// calling thread.
void add_own_cpu_seconds(double seconds);

}  // namespace atlas
