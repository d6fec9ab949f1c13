// The factor by which work may take longer than on an idle machine, for tests that limit its time.
// Such a limit finds loops that grow with the square of their input; it does not measure speed.
#pragma once

namespace atlas::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr double kSlowness = 20;
#else
inline constexpr double kSlowness = 4;
#endif

}  // namespace atlas::test
