// Ignores leaks of third-party libraries, which are not the subject of tests under
// AddressSanitizer.
#pragma once

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/lsan_interface.h>
#endif

namespace atlas::test {

// While an instance exists, memory that the creating thread allocates may leak.
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
