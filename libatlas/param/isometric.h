// Flattening that preserves lengths as well as possible: as-rigid-as-possible local/global descent
// (Liu et al. 2008, "A local/global approach to mesh parameterization") with a weight for shear.
// The solver also has a reweighted form that improves the worst triangles, and a barrier relaxation
// that removes flips.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "libatlas/core/vec.h"
#include "libatlas/param/local_mesh.h"

namespace atlas {

// Scratch memory of the solvers, kept between calls so that thousands of small charts need no
// allocations. Each thread needs its own. Results never depend on earlier calls.
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
  // Triangles have at least this altitude (uv units) in the flat shape that they are to take, so
  // that slivers keep a positive area that survives rounding. There is also always a floor of 1e-9
  // of the longest edge. This gives zero-area triangles a place.
  double min_altitude = 0;
  // The weight of shear relative to change of area, in (0, 1]. If 1 + a and 1 + b are the singular
  // values of a triangle's map, the energy is (a + b)² + shear_weight (a - b)². The value 1 gives
  // as rigid as possible, which is a² + b² up to a factor. To second order, L2 stretch (Sander et
  // al. 2001) at the area-preserving scale grows as with the value 0.5; with few steps, a little
  // more gives the least L2 stretch.
  double shear_weight = 0.6;
};

// Returns the rows of the 2x3 map of the i-th triangle.
using FrameView = std::function<std::array<Vec3f, 2>(std::size_t)>;

// What the first local step starts from. At most one of uvs and frames may be set. If none is,
// rotations are carried over the triangles, beginning with the one nearest to the centre.
struct IsometricStart {
  std::span<const Vec2d> uvs = {};  // one per vertex
  bool rough = false;               // use only the rotations of uvs, as for a projection
  // One per triangle: the rows of a 2x3 map from space to uv, close to a rotation of the triangle's
  // plane into the uv plane (the nearest rotation is taken). Differences between neighbours do no
  // harm: the first solve smooths them.
  FrameView frames = nullptr;
};

struct IsometricResult {
  std::vector<Vec2d> uvs;  // one per vertex
  // Sum over triangles of area * |J - R|² after the last step, where J is uv per surface length and
  // R the nearest rotation, independent of shear_weight.
  double energy = 0;
  // Triangles of non-positive uv area (in floating point; see injectivity.h).
  std::uint64_t flips = 0;
};

// Minimizes the energy with `options.shear_weight` in `options.iterations` steps. The scale is that
// of the surface (times density), but not exactly area-preserving. A step takes O(n) up to factors
// that grow slowly: it uses a band solver for small charts, a sparse factorization up to some ten
// thousand triangles, and a multilevel-preconditioned solver above.
IsometricResult flatten_isometric(const LocalMesh& mesh, const IsometricStart& start,
                                  const IsometricOptions& options, ParamWorkspace& workspace);

}  // namespace atlas
