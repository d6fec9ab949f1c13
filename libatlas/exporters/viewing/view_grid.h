// Internal: a scene as voxels, for choosing where its viewer starts.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/bounds.h"
#include "libatlas/core/context.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/exporters/viewpoint.h"

namespace atlas {

// The scene as voxels, in a frame whose third axis points up. Each filled cell holds the sum of
// the area-weighted normals of the triangles in it, which tells the front of a wall from its back.
// The sum is kept apart for each axis and sign, and so is that of the light times them, since the
// two sides of a partition are often in the same cell.
class ViewGrid {
 public:
  ViewGrid(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices,
           const ViewpointOptions& options, const Context& context);

  glm::dvec3 to_frame(const glm::dvec3& p) const {
    return up_ == Up::z ? p : glm::dvec3(p.z, p.x, p.y);
  }
  glm::dvec3 from_frame(const glm::dvec3& p) const {
    return up_ == Up::z ? p : glm::dvec3(p.y, p.z, p.x);
  }

  int size(int axis) const { return n_[axis]; }
  double cell() const { return cell_; }
  bool lit() const { return lit_; }
  const Bounds<glm::dvec3>& box() const { return box_; }
  double level_diagonal() const;
  bool filled(int x, int y, int z) const { return wall_of_[index(x, y, z)] != kEmpty; }
  glm::dvec3 centre(int x, int y, int z) const {
    return box_.low + (glm::dvec3(x, y, z) + 0.5) * cell_;
  }

  enum class Hit { nothing, front, back };
  struct Ray {
    double distance = 0;  // to the first filled cell, or to the box's border
    Hit hit = Hit::nothing;
    double light = 0;  // 0..1, what is shown there; 0 beyond the box, and without light
  };
  // Walks in steps of half a cell. A step may miss the corner of a cell, which does not matter for
  // a view. `direction` has unit length.
  Ray cast(const glm::dvec3& from, const glm::dvec3& direction) const;

 private:
  static constexpr std::uint32_t kEmpty = 0;
  using Sides = std::array<std::array<float, 2>, 3>;  // of each axis: normals along it, against it
  // What is in a filled cell.
  struct Wall {
    Sides normals{};
    float area = 0;
  };
  struct Corners {
    glm::dvec3 a, b, c;
  };

  std::size_t index(int x, int y, int z) const { return (std::size_t(z) * n_[1] + y) * n_[0] + x; }
  void choose_cells(double coarsest, double finest);
  void mark(const Corners& triangle, float light);
  void mark(const glm::dvec3& p, const glm::vec3& normal, float light);
  double light_of(std::uint32_t wall, const glm::dvec3& direction, Hit hit) const;

  Up up_;
  bool lit_ = false;
  Bounds<glm::dvec3> box_;
  double cell_ = 1;
  std::array<int, 3> n_{};
  std::vector<std::uint32_t> wall_of_;  // 1 per cell, into walls_, or kEmpty
  std::vector<Wall> walls_;             // the first is unused
  std::vector<Sides> shown_;            // 1 per wall, light times normals; empty without light
};

}  // namespace atlas
