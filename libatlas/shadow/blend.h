// Weights that blend the visibilities of two key shadow maps (Ausheva and Kardashov 2023, eq. 3
// and 4), and what keeps them finite.
#pragma once

#include "libatlas/core/vec.h"

namespace atlas {

// How the visibility between two key maps is found from theirs.
enum class KeyBlend {
  linear,            // w0 = 1 - t, w1 = t
  slerp_raw,         // sin((1-t)a)/sin a and sin(ta)/sin a, as published: the sum exceeds one
  slerp_normalised,  // the same two divided by their sum: a lit point stays at exactly one
};

struct BlendWeights {
  double from = 1, to = 0;
};

// Below this sine of the angle between the keys the spherical weights are the linear ones: they
// differ by less than 1e-8 there, and 1/sin would amplify rounding instead.
inline constexpr double kSlerpMinSine = 1e-4;

// Two keys are never further apart than this: raw weights sum to 1/cos(a/2) at t = 1/2, which is
// sqrt(2) at 90 degrees and diverges at 180.
inline constexpr double kMaxKeyDegrees = 90;

// Angle between two directions, radians in [0, pi], accurate near 0 and near pi (atan2, not acos).
// The directions need not have unit length; 0 if either is zero or not finite.
double angle_between(const Vec3d& a, const Vec3d& b);

// Weights at t (clamped to [0, 1]; NaN counts as 0) between key lights `angle` radians apart.
// Spherical weights use at most kMaxKeyDegrees: a larger angle (or NaN) falls back to linear
// weights, since the formula's denominator vanishes at pi. Both weights are in [0, 1].
BlendWeights blend_weights(KeyBlend blend, double t, double angle);

// weights.from * v0 + weights.to * v1, clamped to [0, 1]: raw spherical weights would light a fully
// lit point by up to sqrt(2).
double blend_visibility(const BlendWeights& weights, double v0, double v1);

}  // namespace atlas
