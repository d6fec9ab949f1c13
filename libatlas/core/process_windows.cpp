#ifdef _WIN32
#ifndef NOMINMAX
#define NOMINMAX
#endif
#ifndef WIN32_LEAN_AND_MEAN
#define WIN32_LEAN_AND_MEAN
#endif
#include <windows.h>
// windows.h comes first.
#include <psapi.h>
#undef far
#undef near
#undef small

#include "libatlas/core/clock.h"
#include "libatlas/core/process.h"

namespace atlas {
namespace {

double seconds_of(const FILETIME& kernel, const FILETIME& user) {
  const auto ticks = [](const FILETIME& t) {
    return double(t.dwHighDateTime) * 4294967296.0 + double(t.dwLowDateTime);
  };
  return 1e-7 * (ticks(kernel) + ticks(user));
}

}  // namespace

double cpu_seconds() {
  FILETIME created{}, ended{}, kernel{}, user{};
  GetProcessTimes(GetCurrentProcess(), &created, &ended, &kernel, &user);
  return seconds_of(kernel, user);
}

double thread_cpu_seconds() {
  FILETIME created{}, ended{}, kernel{}, user{};
  GetThreadTimes(GetCurrentThread(), &created, &ended, &kernel, &user);
  return seconds_of(kernel, user);
}

void return_freed_memory() {}

std::int64_t peak_memory() {
  PROCESS_MEMORY_COUNTERS counters{};
  K32GetProcessMemoryInfo(GetCurrentProcess(), &counters, sizeof counters);
  return std::int64_t(counters.PeakWorkingSetSize);
}

std::uint64_t free_address_space() {
  MEMORYSTATUSEX memory{};
  memory.dwLength = sizeof memory;
  return GlobalMemoryStatusEx(&memory) ? memory.ullAvailVirtual : UINT64_MAX;
}

}  // namespace atlas
#endif
