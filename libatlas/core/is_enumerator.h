// Internal: whether a caller's value of an enumeration is one of its enumerators. Values of other
// integers come from casts, such as those of bindings.
#pragma once

#include <type_traits>

namespace atlas {

// `last` is the last enumerator. They count from 0.
template <class Enum>
constexpr bool is_enumerator(Enum value, Enum last) {
  using Number = std::underlying_type_t<Enum>;
  return Number(value) >= 0 && Number(value) <= Number(last);
}

}  // namespace atlas
