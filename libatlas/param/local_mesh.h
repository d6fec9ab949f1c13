// The mesh that the functions in this folder work on: one chart (or candidate chart) with its own
// compact vertex numbering.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"

namespace atlas {

// Points in double; or in float, relative to an origin that is subtracted in double on access,
// which takes half the memory without losing a digit.
class PositionView {
 public:
  PositionView() = default;
  PositionView(std::span<const Vec3d> points) : points_(points) {}
  PositionView(const std::vector<Vec3d>& points) : points_(points) {}
  PositionView(std::span<const Vec3f> points, Vec3f origin)
      : floats_(points), origin_{origin.x, origin.y, origin.z} {}

  std::size_t size() const { return floats_.empty() ? points_.size() : floats_.size(); }
  Vec3d operator[](std::size_t i) const {
    if (floats_.empty()) return points_[i];
    const Vec3f p = floats_[i];
    return {p.x - origin_.x, p.y - origin_.y, p.z - origin_.z};
  }

 private:
  std::span<const Vec3d> points_;
  std::span<const Vec3f> floats_;
  Vec3d origin_;
};

// A view of `triangles` over `positions`; the memory it refers to must outlive it. Every index is
// below positions.size() and the positions are finite. Unless a function says otherwise, the
// triangles form one connected, consistently oriented manifold with a border. Zero-area triangles,
// needles and coincident positions are allowed; a triangle with a repeated vertex is not. Results
// do not depend on the unit of length. Subtract a common origin first, so that no digits are lost
// to a large offset.
struct LocalMesh {
  PositionView positions = {};
  std::span<const std::array<std::uint32_t, 3>> triangles = {};
  // Desired linear density of each triangle (uv length per surface length, > 0), one per triangle;
  // empty: 1 everywhere. Distortion is measured relative to the surface scaled by it.
  std::span<const double> density = {};
  // The opposite of each half-edge (3 t + k runs from corner k of triangle t to corner k + 1),
  // 0xffffffff on the boundary. Empty: opposites are found from the vertices' numbers.
  std::span<const std::uint32_t> opposite = {};
};

// Checks what is said above of single numbers: ranges of indices and repeated vertices, finite
// positions, densities, lengths of arrays. parameterize() does so; the other functions in this
// folder rely on it. Linear. Error: bad_input, naming array and element.
Status check_local_mesh(const LocalMesh& mesh);

}  // namespace atlas
