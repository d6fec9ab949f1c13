// The bound on the work of reading and of charts, in proportion to what comes of it.
#pragma once

#include <cstddef>
#include <string>

#include "libatlas/core/clock.h"
#include "tests/support/slowness.h"

namespace atlas::test {

// Measures CPU time from its construction on.
class Effort {
 public:
  // Returns what is wrong if work on so many triangles (0: the input was refused) took more than
  // 100 microseconds each and a tenth of a second, else an empty text.
  std::string fault(std::size_t triangles) const {
    const double most = kSlowness * (0.1 + 1e-4 * double(triangles)), took = cpu_seconds() - begun_;
    return took <= most ? "" : "too much work: " + std::to_string(took) + " CPU s";
  }

 private:
  double begun_ = cpu_seconds();
};

}  // namespace atlas::test
