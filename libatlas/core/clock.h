// Time and memory of this process, for reports.
#pragma once

#include <cstdint>

namespace atlas {

double wall_seconds();       // since an arbitrary start, monotonic
double cpu_seconds();        // user + system time of all threads of the process
std::int64_t peak_memory();  // largest resident set so far, bytes

}  // namespace atlas
