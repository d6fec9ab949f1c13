// One chart in, its flat coordinates out: injective and within the stretch bound, or a list of the
// triangles that stand in the way.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/vec.h"
#include "libatlas/param/distortion.h"
#include "libatlas/param/injectivity.h"
#include "libatlas/param/isometric.h"
#include "libatlas/param/local_mesh.h"

namespace atlas {

enum class ParamMethod {
  automatic,  // planar where that is within the bound, else isometric
  planar,     // projection only
  isometric,  // never the projection
};

struct ParamOptions {
  double max_stretch = 1.25;  // bound on Distortion::stretch_999; > 1
  // The projection is taken when its own stretch_999 is at most this; <= max_stretch. 0:
  // max_stretch.
  double max_planar_stretch = 0;
  ParamMethod method = ParamMethod::automatic;
  Vec3d axis = {};              // of the projection; (0, 0, 0): the mean normal
  IsometricStart start = {};    // what the isometric solver starts from
  int iterations = 3;           // local/global steps before the bound is looked at
  int squeeze_iterations = 12;  // reweighted steps at most, when the aim is missed:
  double aimed_stretch = 0;     // <= max_stretch; 0: max_stretch. Missed where it is dear in L2.
  // The scale at which squeezing measures: the area-preserving one, as in the bound, or whichever
  // suits best, so that the ratio of the largest to the smallest singular value falls.
  bool squeeze_ratio = false;
  // Within max_stretch is good enough, and what is beyond lies in small places, which alone are
  // relaxed; squeezes only where those are many. For rough surfaces.
  bool local = false;
  // No face is flat: each may give way as far as it helps when the whole is squeezed.
  bool rough = false;
  // Borders that come apart only beyond max_stretch are left as they cross within it, for whoever
  // can take triangles away there.
  bool leave_crossings = false;
  // start.uvs, nearly all of their triangles positive, are kept but where others are turned over or
  // the stretch exceeds the bound: for a flattening that failed, after a cut, or one that grew.
  bool resume = false;
  // 3 a triangle, or empty: parts of the mesh that are flat already, placed next to each other, to
  // go on from instead of `start`. What they stretch is kept, so far as they fit together.
  std::span<const Vec2d> joined = {};
  // One of these parts is small: places beyond the bound are relaxed around it, nothing is solved.
  bool patch = false;
  // Triangles are kept at least this thick (uv units) where possible, so that rounding of what is
  // written leaves them positive.
  double min_altitude = 0;
};

struct ParamResult {
  std::vector<Vec2d> uvs;  // 1 a vertex; uv area = surface area (times density squared), positive
  Distortion distortion;
  bool planar = false;        // the projection was enough
  bool injective = false;     // certain: exact predicates (injectivity.h)
  bool within_bound = false;  // stretch_999 and stretch_l2 <= max_stretch
  // Empty if both hold. Else triangles in the way, worst first: flipped ones, those at border
  // crossings, those beyond the bound. Cutting the chart near or between them helps.
  std::vector<std::uint32_t> offenders;
  // Pairs of border edges that overlap; cutting between the two of a pair helps.
  std::vector<BorderCrossing> crossings;
  // What was left of them when drawing the borders apart had come furthest (edges of the same
  // border, perhaps other pairs); empty if that was not tried, which it is only within the bound.
  std::vector<BorderCrossing> stubborn_crossings;
  int unflipped = 0;  // triangles that the barrier step turned right
};

// Precondition: the mesh is a disc (see local_mesh.h); other sets are flattened too, if connected,
// but may then need cuts that no offender points at. Deterministic; reentrant with one workspace a
// thread. A single triangle always succeeds with stretch 1; a triangle without area is given
// min_altitude.
ParamResult parameterize(const LocalMesh& mesh, const ParamOptions& options,
                         ParamWorkspace& workspace);

}  // namespace atlas
