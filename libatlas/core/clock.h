// Time and memory of this process, for reports.
#pragma once

#include <cstdint>

namespace atlas {

double wall_seconds();        // since an arbitrary start, monotonic
double cpu_seconds();         // user + system time of all threads of the process
double thread_cpu_seconds();  // user + system time of the calling thread
std::int64_t peak_memory();   // largest resident set of this program so far, bytes
// Returns freed memory to the system, if the allocator otherwise keeps it (glibc) and it is 4 MiB
// or more. A call between two stages takes about a millisecond, and peak_memory() then grows less,
// by the size of that memory.
void return_freed_memory();

// Measures the time of consecutive sections of work.
class Stopwatch {
 public:
  explicit Stopwatch(double (*clock)()) : clock_(clock), last_(clock()) {}

  // Returns the seconds since the last lap, or since construction.
  double lap() {
    const double now = clock_(), seconds = now - last_;
    last_ = now;
    return seconds;
  }

 private:
  double (*clock_)();
  double last_;
};

}  // namespace atlas
