// CPU time and peak memory of one piece of work.
#pragma once

#include <functional>

#include "benchmarks/support/results.h"

namespace atlas::bench {

// Runs `work` `repeats` (>= 1) times and fills cpu_seconds, cpu_spread, wall_seconds, memory_mib,
// input_mib. First gives freed memory back to the system and, where Linux allows it
// (/proc/self/clear_refs), resets the high-water mark; otherwise that is the peak of the process so
// far. Memory that an allocator keeps nevertheless counts as input and hides what the work needs,
// so measure memory with in_own_process(). Stops at the first failure, which it stores in
// row.failure.
void measure(int repeats, Row& row, const std::function<Status()>& work);

}  // namespace atlas::bench
