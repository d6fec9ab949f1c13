// Time and memory of this process, for reports.
#pragma once

#include <cstdint>

namespace atlas {

double wall_seconds();        // since an arbitrary start, monotonic
double cpu_seconds();         // user + system time of all threads of the process
double thread_cpu_seconds();  // the same of the calling thread
std::int64_t peak_memory();   // largest resident set so far, bytes
// Gives memory that was freed back to the system, where the allocator keeps it until told (glibc)
// and it is 4 MiB or more. A call between two stages takes a millisecond or so; peak_memory()
// grows that much less.
void return_freed_memory();

// Times sections of work that follow each other.
class Stopwatch {
 public:
  explicit Stopwatch(double (*clock)()) : clock_(clock), last_(clock()) {}

  // Seconds since the last lap, or since the start.
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
