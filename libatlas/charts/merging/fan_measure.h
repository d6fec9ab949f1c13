// Internal: what flattening makes of the fans of a coarse mesh.
#pragma once

#include <span>
#include <vector>

#include "libatlas/charts/merging/fan_solver.h"

namespace atlas {

struct FanStretch {
  bool flipped = false;  // a triangle; then only the energy is known
  double l2 = 1, high_area = 0;
  double energy = 0;  // area times (l2 squared - 1); of a map with flips what it costs at least
};

class FanMeasure {
 public:
  explicit FanMeasure(const Fans& fans) : fans_(fans) {}

  // At the scale that keeps the area: the mean stretch, the area stretched by more than `high`.
  FanStretch stretch(const JoinedFans& joined, std::span<const Vec2d> uvs, double high);
  // Of the flat fans, negative where they are mirrored.
  double twice_area(const JoinedFans& joined, std::span<const Vec2d> uvs, bool& flipped);
  // The area (not twice) by the maps of the triangles: those without area on the surface have none.
  double mapped_area(const JoinedFans& joined, std::span<const Vec2d> uvs);

 private:
  struct Kernels;

  void resize(const JoinedFans& joined);
  double rigid_energy() const;

  const Fans& fans_;
  // 1 a triangle and some beyond: of the map to uv the sum of the squared singular values and their
  // product, the area.
  std::vector<double> squares_, product_, area_;
  std::size_t count_ = 0;
};

}  // namespace atlas
