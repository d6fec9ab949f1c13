// Leaks of other people's libraries, which the tests under AddressSanitizer are not about.
#pragma once

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/lsan_interface.h>
#endif

namespace atlas::test {

// What is allocated while one lives, by the thread that made it, may leak.
class IgnoreLeaks {
 public:
#if defined(__SANITIZE_ADDRESS__)
  IgnoreLeaks() {
    __lsan_disable();
  }
  ~IgnoreLeaks() {
    __lsan_enable();
  }
#else
  IgnoreLeaks() {}
#endif
  IgnoreLeaks(const IgnoreLeaks&) = delete;
  IgnoreLeaks& operator=(const IgnoreLeaks&) = delete;
};

}  // namespace atlas::test
