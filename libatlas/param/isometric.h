// Flattenings that keep lengths as well as can be: as-rigid-as-possible local/global descent (Liu
// et al. 2008, "A local/global approach to mesh parameterization") with a weight for shear, its
// reweighted form that lowers the worst triangles, and a barrier relaxation that removes flips.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "libatlas/core/vec.h"
#include "libatlas/param/local_mesh.h"

namespace atlas {

// Scratch memory of the solvers, kept between calls so that thousands of small charts cost no
// allocation. One for each thread; results never depend on what was solved before.
class ParamWorkspace {
 public:
  ParamWorkspace();
  ~ParamWorkspace();
  ParamWorkspace(ParamWorkspace&&) noexcept;
  ParamWorkspace& operator=(ParamWorkspace&&) noexcept;
  struct Impl;
  Impl& impl() { return *impl_; }

  // CPU seconds of parameterize() with this workspace, on meshes of at least timed_triangles.
  static constexpr std::size_t timed_triangles = 256;
  struct Timing {
    double solve = 0, flips = 0, overlaps = 0;
  } timing;

 private:
  std::unique_ptr<Impl> impl_;
};

struct IsometricOptions {
  int iterations = 5;  // local/global steps
  // Triangles are given at least this altitude (uv units) in the plane shape they strive for, so
  // that slivers keep a positive area that survives rounding. Besides it there is always a floor of
  // 1e-9 of the longest edge. Zero-area triangles get a place this way.
  double min_altitude = 0;
  // How much shear counts against change of area, in (0, 1]. With singular values 1 + a and 1 + b
  // of a triangle's map the energy is (a + b)² + shear_weight (a - b)². 1: as rigid as possible,
  // which is a² + b² but for a factor. L2 stretch (Sander et al. 2001) at the area-preserving scale
  // grows as a half makes it, in second order; a little more is what few steps reach it best with.
  double shear_weight = 0.6;
};

// The rows of each triangle's 2x3 map.
using FrameView = std::function<std::array<Vec3f, 2>(std::size_t)>;

// What the first local step starts from; exactly one of uvs and frames is set, or none: then the
// rotations are carried over the triangles from the one nearest to the middle.
struct IsometricStart {
  std::span<const Vec2d> uvs = {};  // 1 a vertex
  bool rough = false;               // of uvs only the rotations count, as of a projection
  // 1 a triangle: rows of a 2x3 map from space to uv, near a rotation of the triangle's plane into
  // the uv plane (the nearest one is taken). Jumps between neighbours are fine: the first solve
  // levels them.
  FrameView frames = nullptr;
};

struct IsometricResult {
  // Sum over triangles of area * |J - R|² after the last step, J = uv per surface length, R the
  // nearest rotation; whatever the shear's weight.
  double energy = 0;
  std::uint64_t flips =
      0;  // triangles of non-positive uv area (in floating point; see injectivity.h)
};

// Minimises the energy of `options.shear_weight` in so many steps and writes uvs (1 a vertex).
// `start.uvs` may be the same memory as `uvs`. The scale is that of the surface (times density);
// not area-preserving to the last digit. O(n) a step up to factors that grow slowly: a band solver
// for small charts, a sparse factorisation up to some ten thousand triangles, a
// multilevel-preconditioned solve above.
IsometricResult flatten_isometric(const LocalMesh& mesh, const IsometricStart& start,
                                  const IsometricOptions& options, std::span<Vec2d> uvs,
                                  ParamWorkspace& workspace);

}  // namespace atlas
