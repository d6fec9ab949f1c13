// Internal: four floats that the compiler keeps in one SIMD register (a vector extension of GCC and
// Clang). Inner loops use them for colours.
#pragma once

#include "libatlas/core/srgb.h"

namespace atlas {

using Lanes = float __attribute__((vector_size(16)));
using IntLanes = std::int32_t __attribute__((vector_size(16)));

inline Lanes splat_lanes(float v) {
  return Lanes{v, v, v, v};
}

// larger_lanes is `a > b ? a : b` of each lane, and smaller_lanes is `a < b ? a : b`. Both give `b`
// if one of the two is NaN. The intrinsics are one instruction, which compilers do not make of
// these expressions.
#ifdef __SSE__
inline Lanes larger_lanes(Lanes a, Lanes b) {
  return __builtin_ia32_maxps(a, b);
}
inline Lanes smaller_lanes(Lanes a, Lanes b) {
  return __builtin_ia32_minps(a, b);
}
#else
inline Lanes larger_lanes(Lanes a, Lanes b) {
  return a > b ? a : b;
}
inline Lanes smaller_lanes(Lanes a, Lanes b) {
  return a < b ? a : b;
}
#endif

// Clamps each lane to [low, high]. NaN gives `low`.
inline Lanes clamp_lanes(Lanes v, float low, float high) {
  return smaller_lanes(larger_lanes(v, splat_lanes(low)), splat_lanes(high));
}

// quantize8 of each lane.
inline IntLanes quantize_lanes(Lanes display) {
  return __builtin_convertvector(clamp_lanes(display * 255.0f + 0.5f, 0, 255), IntLanes);
}

namespace srgb_detail {

// Loads start and rise of a piece at once.
inline double piece_as_double(std::int32_t index) {
  return std::bit_cast<double>(tables.encode[static_cast<std::uint32_t>(index)]);
}

}  // namespace srgb_detail

// Applies srgb_encode to the first three lanes. The 4th becomes 1.
inline Lanes srgb_encode_lanes(Lanes linear) {
  using namespace srgb_detail;
  const Lanes v = clamp_lanes(linear, 0, 1);
  const Lanes smallest = splat_lanes(1.0f / (1 << kOctaves));
  const auto bits = reinterpret_cast<IntLanes>(larger_lanes(v, smallest));
  const IntLanes index = (bits - static_cast<std::int32_t>(kFirst)) >> (23 - kPieceBits);
  const IntLanes low = bits & ((1 << (23 - kPieceBits)) - 1);
  const Lanes t = __builtin_convertvector(low, Lanes) * (1.0f / (1 << (23 - kPieceBits)));
  using Pieces = double __attribute__((vector_size(16)));
  const auto p01 =
      reinterpret_cast<Lanes>(Pieces{piece_as_double(index[0]), piece_as_double(index[1])});
  const auto p2 = reinterpret_cast<Lanes>(Pieces{piece_as_double(index[2]), 0});
  const Lanes start = __builtin_shufflevector(p01, p2, 0, 2, 4, 6);
  const Lanes rise = __builtin_shufflevector(p01, p2, 1, 3, 5, 7);
  Lanes out = v < smallest ? v * 12.92f : start + t * rise;
  out[3] = 1;
  return out;
}

}  // namespace atlas
