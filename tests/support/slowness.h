// How much longer than usual work may take, for tests that bound its time.
#pragma once

namespace atlas::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr double kSlowness = 10;  // sanitizers
#else
inline constexpr double kSlowness = 1;
#endif

}  // namespace atlas::test
