// The factor by which work may take longer than usual, for tests that limit its time.
#pragma once

namespace atlas::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr double kSlowness = 10;  // under sanitizers
#else
inline constexpr double kSlowness = 1;
#endif

}  // namespace atlas::test
