// The factor by which work may take longer than on an idle machine, for tests that limit its time.
// Such a limit finds loops that grow with the square of their input; it does not measure speed.
#pragma once

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)  // GCC
#define ATLAS_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define ATLAS_SANITIZED
#endif
#endif

namespace atlas::test {

#ifdef ATLAS_SANITIZED
inline constexpr double kSlowness = 20;
#else
inline constexpr double kSlowness = 4;
#endif

}  // namespace atlas::test
