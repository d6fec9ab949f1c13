// Internal: the rotation and translation that best take points of the plane to others (Procrustes).
#pragma once

#include <algorithm>
#include <cmath>

#include "libatlas/core/glm_bridge.h"

namespace atlas {

// A rotation, as a complex factor, and a translation.
struct Motion {
  glm::dvec2 turn{1, 0}, shift{0};
  // Root mean square distance between corresponding points, relative to the sum of the weights.
  double misfit = 0;

  glm::dvec2 operator()(glm::dvec2 p) const { return turned(p) + shift; }
  Vec2d operator()(Vec2d p) const { return from_glm((*this)(to_glm(p))); }
  glm::dvec2 turned(glm::dvec2 p) const {
    return {turn.x * p.x - turn.y * p.y, turn.y * p.x + turn.x * p.y};
  }
};

// Sums over pairs of points. Coordinates are relative to the first pair, to avoid cancellation.
class RigidFit {
 public:
  RigidFit(glm::dvec2 from, glm::dvec2 to) : from_origin_(from), to_origin_(to) {}

  void add(glm::dvec2 from, glm::dvec2 to, double weight) {
    const glm::dvec2 p = from - from_origin_, q = to - to_origin_;
    weight_ += weight;
    from_ += weight * p;
    to_ += weight * q;
    dot_ += weight * glm::dot(p, q);
    cross_ += weight * (p.x * q.y - p.y * q.x);
    squares_ += weight * (glm::dot(p, p) + glm::dot(q, q));
  }

  // Returns the sums over what was added since `earlier`.
  RigidFit since(const RigidFit& earlier) const {
    RigidFit rest = *this;
    rest.weight_ -= earlier.weight_;
    rest.from_ -= earlier.from_;
    rest.to_ -= earlier.to_;
    rest.dot_ -= earlier.dot_;
    rest.cross_ -= earlier.cross_;
    rest.squares_ -= earlier.squares_;
    return rest;
  }

  double weight() const { return weight_; }

  Motion motion() const {
    Motion motion;
    if (!(weight_ > 0)) return motion;
    const glm::dvec2 p = from_ / weight_, q = to_ / weight_;
    const double c = dot_ - weight_ * glm::dot(p, q);
    const double s = cross_ - weight_ * (p.x * q.y - p.y * q.x);
    const double spread = squares_ - weight_ * (glm::dot(p, p) + glm::dot(q, q));
    const double norm = std::sqrt(c * c + s * s);
    if (norm > 0) motion.turn = glm::dvec2(c, s) / norm;
    motion.shift = to_origin_ + q - motion.turned(from_origin_ + p);
    motion.misfit = std::sqrt(std::max(spread - 2 * norm, 0.0) / weight_) / weight_;
    return motion;
  }

 private:
  glm::dvec2 from_origin_, to_origin_;
  double weight_ = 0, dot_ = 0, cross_ = 0, squares_ = 0;
  glm::dvec2 from_{0}, to_{0};
};

}  // namespace atlas
