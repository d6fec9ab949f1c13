// Internal: measures the stretch of a flattening of the fans of a coarse mesh.
#pragma once

#include <span>
#include <vector>

#include "libatlas/charts/merging/fan_solver.h"

namespace atlas {

struct FanStretch {
  bool flipped = false;  // some triangle is; then only `energy` is filled
  double l2 = 1, high_area = 0;
  // Area times (l2 squared - 1); of a map with flips, a lower bound on what it costs.
  double energy = 0;
};

class FanMeasure {
 public:
  explicit FanMeasure(const Fans& fans) : fans_(fans) {}

  // Returns, at the area-preserving scale, the L2 stretch and the area stretched by more than
  // `high`.
  FanStretch stretch(const JoinedFans& joined, std::span<const Vec2d> uvs, double high);
  // Returns twice the area of the flat fans, where mirrored triangles count negatively.
  double twice_area(const JoinedFans& joined, std::span<const Vec2d> uvs, bool& flipped);
  // Returns the flat area (not twice), summed over the triangles' maps. Triangles without area on
  // the surface count as zero.
  double mapped_area(const JoinedFans& joined, std::span<const Vec2d> uvs);

 private:
  struct Kernels;

  void resize(const JoinedFans& joined);
  double rigid_energy() const;

  const Fans& fans_;
  // One per triangle, and some beyond: the sum of the squared singular values of the map to uv,
  // their product, and the area.
  std::vector<double> squares_, product_, area_;
  std::size_t count_ = 0;
};

}  // namespace atlas
