#include "benchmarks/support/measure.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>
#include <fstream>
#include <string>

#include "benchmarks/support/callgrind.h"
#include "libatlas/core/clock.h"

namespace atlas::bench {
namespace {

void reset_peak() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
  std::ofstream("/proc/self/clear_refs") << "5";
}

// Returns VmRSS (resident now) or VmHWM (the largest since reset_peak()), in MiB.
double resident_mib(const std::string& which) {
  std::ifstream file("/proc/self/status");
  for (std::string word; file >> word;) {
    if (word != which) continue;
    double kib = 0;
    file >> kib;
    return kib / 1024;
  }
  return double(peak_memory()) / (1 << 20);
}

}  // namespace

void measure(int repeats, Row& row, const std::function<Status()>& work) {
  double least = 0, most = 0;
  for (int i = 0; i < repeats; ++i) {
    reset_peak();
    if (i == 0) row.input_mib = resident_mib("VmRSS:");
    const double cpu = cpu_seconds(), wall = wall_seconds();
    const Status status = [&] {
      const CountedWork counted(row.key());
      return work();
    }();
    const double spent = cpu_seconds() - cpu, elapsed = wall_seconds() - wall;
    if (!status.ok()) {
      row.failure = status.message();
      return;
    }
    row.memory_mib = std::max(row.memory_mib, resident_mib("VmHWM:"));
    if (i == 0 || spent < least) {
      least = spent;
      row.wall_seconds = elapsed;
    }
    most = std::max(most, spent);
  }
  row.cpu_seconds = least;
  row.cpu_spread = least > 0 ? most / least - 1 : 0;
}

}  // namespace atlas::bench
