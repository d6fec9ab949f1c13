// CPU time and peak memory of one piece of work.
#pragma once

#include <functional>

#include "benchmarks/support/results.h"

namespace atlas::bench {

// Runs `work` `repeats` (>= 1) times and fills cpu_seconds, cpu_spread, wall_seconds, memory_mib,
// input_mib. Memory freed before is given back to the system first, and the high-water mark reset
// where Linux lets a process do so (/proc/self/clear_refs); elsewhere it is the process's peak so
// far. What an allocator keeps nevertheless counts as input and hides what the work needs: measure
// memory in_own_process(). Stops at the first failure, which it stores in row.failure.
void measure(int repeats, Row& row, const std::function<Status()>& work);

}  // namespace atlas::bench
