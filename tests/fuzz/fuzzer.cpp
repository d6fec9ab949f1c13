// A program for libFuzzer, of the target FUZZ_TARGET(bytes). Its limits are on CPU time, since
// libFuzzer's own are on the clock's, which a busy machine lets run out: an input may take 10 s,
// and after the seconds that LIBATLAS_FUZZ_SECONDS names (if set) the run ends as on SIGUSR1.
#include <sys/time.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "libatlas/core/clock.h"
#include "tests/fuzz/targets.h"

namespace {

constexpr int kSecondsAnInput = 10;

void end_slow_input(int) {
  std::fprintf(stderr, "an input takes more than %d CPU s\n", kSecondsAnInput);
  std::abort();  // so that the fuzzer keeps the input
}

void set_timer(int seconds) {
  itimerval timer = {};
  timer.it_value.tv_sec = seconds;
  ::setitimer(ITIMER_PROF, &timer, nullptr);
}

// Measures the inputs, and ends the run when it is time.
class Budget {
 public:
  Budget() {
    std::signal(SIGPROF, end_slow_input);
    if (const char* seconds = std::getenv("LIBATLAS_FUZZ_SECONDS")) most_ = std::atof(seconds);
  }
  void begin() {
    begun_ = atlas::cpu_seconds();
    set_timer(kSecondsAnInput);
  }
  void end() {
    set_timer(0);
    const double now = atlas::cpu_seconds();
    slowest_ = std::max(slowest_, now - begun_);
    if (most_ == 0 || now < most_) return;
    std::fprintf(stderr, "stat::cpu_seconds: %.0f\nstat::slowest_cpu_seconds: %.2f\n", now,
                 slowest_);
    most_ = 0;
    std::raise(SIGUSR1);
  }

 private:
  double most_ = 0, begun_ = 0, slowest_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Budget budget;
  const atlas::test::FuzzBytes bytes(data, size);
  budget.begin();
  const std::string fault = FUZZ_TARGET.fault;
  budget.end();
  if (fault.empty()) return 0;
  std::fprintf(stderr, "%s\n", fault.c_str());
  std::abort();
}
