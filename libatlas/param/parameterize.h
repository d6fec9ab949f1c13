// Flattens one chart: the result is injective and within the stretch bound, or lists the triangles
// that prevent this.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"
#include "libatlas/param/distortion.h"
#include "libatlas/param/injectivity.h"
#include "libatlas/param/isometric.h"
#include "libatlas/param/local_mesh.h"

namespace atlas {

enum class ParamMethod {
  automatic,  // planar if that is within the bound, else isometric
  planar,     // projection only
  isometric,  // never the projection
};

struct ParamOptions {
  double max_stretch = 1.25;  // bound on Distortion::stretch_999 and stretch_l2; > 1
  ParamMethod method = ParamMethod::automatic;
  // Of the projection, of any length; (0, 0, 0), or not finite: the mean normal.
  Vec3d axis = {};
  IsometricStart start = {};    // what the isometric solver starts from
  int iterations = 5;           // local/global steps before the bound is checked
  int squeeze_iterations = 12;  // most reweighted steps, if the bound is missed
  // Triangles keep at least this altitude (uv units) where possible, so that they stay positive
  // when the result is rounded for output.
  double min_altitude = 0;
};

struct ParamResult {
  // One per vertex. The uv area is the surface area (times density squared), and positive.
  std::vector<Vec2d> uvs = {};
  Distortion distortion = {};
  bool planar = false;        // the projection was good enough
  bool injective = false;     // certain, by exact predicates (injectivity.h)
  bool within_bound = false;  // stretch_999 and stretch_l2 <= max_stretch
  // Empty if both hold. Otherwise the triangles that prevent it, worst first: flipped ones, those
  // at border crossings, those beyond the bound. It helps to cut the chart near or between them.
  std::vector<std::uint32_t> offenders = {};
  // Pairs of border edges that overlap. It helps to cut between the two edges of a pair.
  std::vector<BorderCrossing> crossings = {};
  // The crossings that remained when moving the borders apart had come furthest (edges of the same
  // border, perhaps other pairs). Empty if that was not tried; it is only tried within the bound.
  std::vector<BorderCrossing> stubborn_crossings = {};
  int unflipped = 0;  // flipped triangles that the barrier step corrected
};

// Flattens a chart. The mesh must be a disc (see local_mesh.h); other connected meshes are
// flattened too, but may need cuts that no offender indicates. Deterministic; reentrant with one
// workspace per thread. A single triangle always succeeds with stretch 1; a triangle without area
// gets min_altitude. Without any triangle, all uvs are (0, 0), neither injective nor within the
// bound. Lengths may have any magnitude, but the areas of the distortion become 0 or infinite where
// doubles cannot hold them. Errors: bad_input, see check_local_mesh(), or because IsometricStart
// has both uvs and frames, another number of uvs than of vertices, or a uv that is not finite;
// bad_option.
Result<ParamResult> parameterize(const LocalMesh& mesh, const ParamOptions& options,
                                 ParamWorkspace& workspace);

}  // namespace atlas
