// Internal: parameterize() with what the segmentation into charts needs beyond it, and two ways to
// go on from uvs that are there already.
#pragma once

#include <span>

#include "libatlas/param/parameterize.h"

namespace atlas::param {

struct FlattenOptions : ParamOptions {
  // The projection is used if its own stretch_999 and stretch_l2 are at most this; <= max_stretch.
  // 0: max_stretch.
  double max_planar_stretch = 0;
  // Only the small places beyond the bound are relaxed. The whole is squeezed only if there are
  // many of them. For rough surfaces.
  bool local = false;
  // No face is flat: when the whole is squeezed, each triangle may give way as far as it helps.
  bool rough = false;
  // The scale at which squeezing measures. false: the area-preserving one, as for the bound. true:
  // the one that suits best, so that the ratio of the largest to the smallest singular value falls.
  // For comparison with closed forms.
  bool squeeze_ratio = false;
};

// As atlas::parameterize(), which is this with the further options left out.
ParamResult flatten_disc(const LocalMesh& mesh, const FlattenOptions& options,
                         ParamWorkspace& workspace);

// Begins with `uvs`, one per vertex, of which nearly all triangles must be positive, and solves
// nothing: flipped triangles are relaxed where they are. Beyond the bound the whole is squeezed,
// or, with FlattenOptions::local, only the places beyond it are relaxed. For a part of a chart, or
// one that grew. `method`, `axis` and `start` have no effect.
ParamResult resume_flattening(const LocalMesh& mesh, std::span<const Vec2d> uvs,
                              const FlattenOptions& options, ParamWorkspace& workspace);

// Parts of a mesh that are flat already and placed side by side.
struct FlatParts {
  std::span<const Vec2d> corner_uvs;  // three per triangle
  // One of the parts is small: places beyond the bound are relaxed around it, and nothing is
  // solved.
  bool patch = false;
};

// Begins with the projection, as flatten_disc() does, and otherwise with the parts, whose stretch
// is kept as far as they fit each other. FlattenOptions::start has no effect.
ParamResult join_flat_parts(const LocalMesh& mesh, const FlatParts& parts,
                            const FlattenOptions& options, ParamWorkspace& workspace);

}  // namespace atlas::param
