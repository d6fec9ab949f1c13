#include "libatlas/core/clock.h"

#include <chrono>

namespace atlas {

double wall_seconds() {
  using Clock = std::chrono::steady_clock;
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

}  // namespace atlas
