// How many fields a struct has, so that a test of all of them notices a new one.
#pragma once

#include <cstddef>

namespace atlas::test {

// Converts to anything, in unevaluated expressions.
struct AnyField {
  template <class T>
  operator T() const;
};

// Returns the number of initialisers that an aggregate takes; a base class counts as one.
template <class Struct, class... Fields>
constexpr std::size_t field_count() {
  if constexpr (requires { Struct{Fields{}..., AnyField{}}; })
    return field_count<Struct, Fields..., AnyField>();
  else
    return sizeof...(Fields);
}

}  // namespace atlas::test
