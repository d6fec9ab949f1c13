// Internal: draws parts of a chart apart that come near each other in uv but not on the surface.
#pragma once

#include <span>
#include <vector>

#include "libatlas/param/distortion.h"
#include "libatlas/param/local_mesh.h"
#include "libatlas/param/near_parts.h"

namespace atlas {

struct WidenOptions {
  double clearance = 0;  // wanted, in units of uv; > 0
  // Of the result (Distortion::stretch_999), or what it was before where that is more.
  double max_stretch = 1.25;
  double min_altitude = 0;  // as ParamOptions::min_altitude
};

struct Widened {
  double border = 0;                       // its length, in units of uv
  double near_before = 0, near_after = 0;  // of it, what is nearer than the clearance
  Distortion distortion;                   // of the result, if anything moved
  bool moved = false;
};

// Only looks.
Widened measure_gaps(const LocalMesh& mesh, double clearance, std::span<const Vec2d> uvs);

// Border vertices that are nearer than the clearance to a part that is far from them on the surface
// (NearParts) are drawn back by half of what is missing, and the triangles around them follow
// without flipping, round by round. The best of the rounds is kept if its map is injective and
// keeps to the bound; else uvs stay as they are, as they do where nothing is near. The map must be
// injective. Deterministic.
Widened widen_gaps(const LocalMesh& mesh, const WidenOptions& options, std::span<Vec2d> uvs);

}  // namespace atlas
