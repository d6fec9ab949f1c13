// Included before every source for WebAssembly: what C++20 has and the standard library of
// Emscripten 3.1 (libc++ 13) lacks. Nothing here is seen by another build.
#pragma once

#include <atomic>
#include <cstring>
#include <type_traits>
#include <version>

namespace std {

#ifndef __cpp_lib_bit_cast
template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
  static_assert(sizeof(To) == sizeof(From));
  return __builtin_bit_cast(To, from);
}
#endif

#ifndef __cpp_lib_atomic_ref
// There is one thread, so that plain reading and writing is atomic.
template <class T>
class atomic_ref {
 public:
  explicit atomic_ref(T& value) : value_(value) {}
  T load(memory_order = memory_order_seq_cst) const { return value_; }
  void store(T value, memory_order = memory_order_seq_cst) const { value_ = value; }

 private:
  T& value_;
};
#endif

}  // namespace std
