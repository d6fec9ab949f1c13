// Weights that blend the visibilities of two key shadow maps (Ausheva and Kardashov 2023, eq. 3
// and 4), and the limits that keep these weights finite.
#pragma once

#include "libatlas/core/vec.h"

namespace atlas {

// How the visibility between two key maps is computed from the visibilities in both.
enum class KeyBlend {
  linear,            // w0 = 1 - t, w1 = t
  slerp_raw,         // sin((1-t)a)/sin a and sin(ta)/sin a, as published; their sum exceeds one
  slerp_normalised,  // the same two divided by their sum; a lit point stays at exactly one
};

struct BlendWeights {
  double from = 1, to = 0;
};

// Below this sine of the angle between the keys, the linear weights replace the spherical ones. The
// two differ by less than 1e-8 there, and dividing by the sine would amplify rounding.
inline constexpr double kSlerpMinSine = 1e-4;

// Two keys are never further apart than this. The raw weights sum to 1/cos(a/2) at t = 1/2, which
// is sqrt(2) at 90 degrees and diverges at 180.
inline constexpr double kMaxKeyDegrees = 90;

// Returns the angle between two directions in radians, in [0, pi]. It is accurate near 0 and near
// pi, because it uses atan2 and not acos. The directions need not have unit length. The result is 0
// if either direction is zero or not finite.
double angle_between(const Vec3d& a, const Vec3d& b);

// Returns the weights at the position t between two key lights that are `angle` radians apart. t is
// clamped to [0, 1], and NaN counts as 0. The spherical formula is used up to kMaxKeyDegrees. For a
// larger angle (or NaN) the weights are linear, since the formula's denominator vanishes at pi.
// Both weights are in [0, 1].
BlendWeights blend_weights(KeyBlend blend, double t, double angle);

// Returns weights.from * v0 + weights.to * v1, clamped to [0, 1]. Without the clamp, raw spherical
// weights would light a fully lit point by up to sqrt(2).
double blend_visibility(const BlendWeights& weights, double v0, double v1);

}  // namespace atlas
