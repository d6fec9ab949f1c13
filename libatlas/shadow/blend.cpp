#include "libatlas/shadow/blend.h"

#include <algorithm>
#include <cmath>

#include "libatlas/core/degrees.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {

double angle_between(const Vec3d& a, const Vec3d& b) {
  const double la = std::hypot(a.x, a.y, a.z), lb = std::hypot(b.x, b.y, b.z);
  if (!(la > 0 && lb > 0) || !std::isfinite(la) || !std::isfinite(lb)) return 0;
  const glm::dvec3 u = to_glm(a) / la, v = to_glm(b) / lb;
  return 2 * std::atan2(glm::length(u - v), glm::length(u + v));
}

BlendWeights blend_weights(KeyBlend blend, double t, double angle) {
  t = t > 0 ? std::min(t, 1.0) : 0.0;  // the comparison sends NaN to 0
  const BlendWeights linear{1 - t, t};
  constexpr double kMaxAngle = radians(kMaxKeyDegrees);
  const double sine = std::sin(angle);
  if (blend == KeyBlend::linear || !(sine >= kSlerpMinSine) || !(angle <= kMaxAngle * (1 + 1e-12)))
    return linear;
  BlendWeights w{std::sin((1 - t) * angle) / sine, std::sin(t * angle) / sine};
  if (blend == KeyBlend::slerp_normalised) {
    const double sum = w.from + w.to;  // at least one
    w = {w.from / sum, w.to / sum};
  }
  return w;
}

double blend_visibility(const BlendWeights& weights, double v0, double v1) {
  const double v = weights.from * v0 + weights.to * v1;
  return v > 0 ? std::min(v, 1.0) : 0.0;
}

}  // namespace atlas
