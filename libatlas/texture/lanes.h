// Internal: four floats that the compiler keeps in one SIMD register (GCC and Clang vector
// extension), for colours in inner loops.
#pragma once

#include "libatlas/texture/srgb.h"

namespace atlas {

using Lanes = float __attribute__((vector_size(16)));
using IntLanes = std::int32_t __attribute__((vector_size(16)));

inline Lanes splat_lanes(float v) {
  return Lanes{v, v, v, v};
}

// NaN gives `low`.
inline Lanes clamp_lanes(Lanes v, float low, float high) {
  const Lanes l = splat_lanes(low), h = splat_lanes(high);
  v = v > l ? v : l;
  return v < h ? v : h;
}

// srgb_encode of the first three lanes; the 4th becomes 1.
inline Lanes srgb_encode_lanes(Lanes linear) {
  using namespace srgb_detail;
  const Lanes v = clamp_lanes(linear, 0, 1);
  const Lanes smallest = splat_lanes(1.0f / (1 << kOctaves));
  const auto bits = reinterpret_cast<IntLanes>(v > smallest ? v : smallest);
  const IntLanes index = (bits - static_cast<std::int32_t>(kFirst)) >> (23 - kPieceBits);
  const IntLanes low = bits & ((1 << (23 - kPieceBits)) - 1);
  const Lanes t = __builtin_convertvector(low, Lanes) * (1.0f / (1 << (23 - kPieceBits)));
  const float* table = tables.encode;
  const Lanes a{table[index[0]], table[index[1]], table[index[2]], 1};
  const Lanes b{table[index[0] + 1], table[index[1] + 1], table[index[2] + 1], 1};
  Lanes out = v < smallest ? v * 12.92f : a + t * (b - a);
  out[3] = 1;
  return out;
}

}  // namespace atlas
