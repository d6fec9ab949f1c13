// Internal: vectors that hold two colours, each as Lanes. They are for functions marked ATLAS_WIDE
// (core/wide_vectors.h). Files that include this header pass such vectors to inlined functions
// only.
#pragma once

#include "libatlas/core/lanes.h"
#include "libatlas/core/wide_vectors.h"

// The warning is about how functions pass such vectors, which does not matter for inlined
// functions.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace atlas {

using Lanes2 = float __attribute__((vector_size(32)));
using IntLanes2 = std::int32_t __attribute__((vector_size(32)));

ATLAS_INLINE Lanes2 join_lanes(Lanes first, Lanes second) {
  return __builtin_shufflevector(first, second, 0, 1, 2, 3, 4, 5, 6, 7);
}

ATLAS_INLINE Lanes first_of(Lanes2 v) {
  return __builtin_shufflevector(v, v, 0, 1, 2, 3);
}

ATLAS_INLINE Lanes second_of(Lanes2 v) {
  return __builtin_shufflevector(v, v, 4, 5, 6, 7);
}

// The same as larger_lanes and smaller_lanes of Lanes.
ATLAS_INLINE Lanes2 larger_lanes(Lanes2 a, Lanes2 b) {
  return a > b ? a : b;
}
ATLAS_INLINE Lanes2 smaller_lanes(Lanes2 a, Lanes2 b) {
  return a < b ? a : b;
}

}  // namespace atlas
