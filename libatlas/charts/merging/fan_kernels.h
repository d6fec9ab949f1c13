// Internal: helpers for the inner loops over the fans of a coarse mesh, see wide_vectors.h.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "libatlas/charts/merging/fan_solver.h"
#include "libatlas/core/wide_vectors.h"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace atlas {

// A Pair is two neighbouring entries of a row, or a point. Pairs are read in place, since a
// separate Vec2d need not have the alignment of a Pair.
static_assert(sizeof(Vec2d) == sizeof(Pair));

ATLAS_INLINE const Pair& pair_at(const double* from) {
  return *reinterpret_cast<const Pair*>(from);
}
ATLAS_INLINE Pair& pair_at(Vec2d& p) {
  return reinterpret_cast<Pair&>(p);
}
ATLAS_INLINE const Pair& pair_at(const Vec2d& p) {
  return reinterpret_cast<const Pair&>(p);
}

// Four numbers at any alignment. They are not read through a reference to an unaligned type, which
// clang would take for aligned.
struct QuadAt {
  ATLAS_INLINE explicit QuadAt(const double* from) { std::memcpy(&quad, from, sizeof quad); }
  Quad quad;
};
ATLAS_INLINE void put_quad(double* to, const Quad& quad) {
  std::memcpy(to, &quad, sizeof quad);
}

ATLAS_INLINE void take_root(Quad& x) {
#if defined(__SSE2__)
  const __m128d low = _mm_sqrt_pd(__m128d{x[0], x[1]}), high = _mm_sqrt_pd(__m128d{x[2], x[3]});
  x = Quad{low[0], low[1], high[0], high[1]};
#else
  x = Quad{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
#endif
}

// The sides of four triangles of a fan: from its centre to their slots, and to the next slots.
struct Sides {
  Quad ax, ay, bx, by;
};
// The coordinates of four points.
struct FourPoints {
  Quad x, y;
};
ATLAS_INLINE FourPoints gather(const Pair& p0, const Pair& p1, const Pair& p2, const Pair& p3) {
  const Quad even = __builtin_shufflevector(p0, p2, 0, 1, 2, 3),
             odd = __builtin_shufflevector(p1, p3, 0, 1, 2, 3);
  return {__builtin_shufflevector(even, odd, 0, 4, 2, 6),
          __builtin_shufflevector(even, odd, 1, 5, 3, 7)};
}
ATLAS_INLINE void find_sides(const JoinedFans::Triangle* four, const Vec2d* uvs,
                             const Vec2d& centre, Sides& sides) {
  const FourPoints a = gather(pair_at(uvs[four[0].a]), pair_at(uvs[four[1].a]),
                              pair_at(uvs[four[2].a]), pair_at(uvs[four[3].a]));
  const FourPoints b = gather(pair_at(uvs[four[0].b]), pair_at(uvs[four[1].b]),
                              pair_at(uvs[four[2].b]), pair_at(uvs[four[3].b]));
  sides.ax = a.x - centre.x;
  sides.ay = a.y - centre.y;
  sides.bx = b.x - centre.x;
  sides.by = b.y - centre.y;
}

}  // namespace atlas
