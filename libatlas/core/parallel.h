// Parallel loops (oneTBB behind the .cpp) whose results cannot depend on the number of threads:
// the range is cut into chunks by `grain` alone, and chunks write disjoint outputs.
#pragma once

#include <cstddef>
#include <functional>

#include "libatlas/core/context.h"

namespace atlas {

// Calls body(begin, end) over [0, n) in chunks of at most `grain` (>= 1) indices, on up to
// context.threads threads. Once context.cancelled(), chunks not yet begun are skipped: the caller
// checks context.cancelled() afterwards.
// A loop within a chunk of another one shares its threads.
void parallel_for(const Context& context, std::size_t n, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

// How many threads a context asks for: the machine's where it leaves that open; at least 1.
std::size_t thread_count(const Context& context);

// CPU time of the calling thread, and of what its loops and background tasks (background.h) have
// run on others: what a call took, whatever else the process does meanwhile. Seconds, for
// differences only.
double own_cpu_seconds();

// Adds to own_cpu_seconds() of the calling thread what another thread has spent for it.
void add_own_cpu_seconds(double seconds);

}  // namespace atlas
