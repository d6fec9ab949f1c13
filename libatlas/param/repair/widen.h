// Internal: moves parts of a chart apart that are close to each other in uv but not on the surface.
#pragma once

#include <span>
#include <vector>

#include "libatlas/param/distortion.h"
#include "libatlas/param/local_mesh.h"
#include "libatlas/param/repair/near_parts.h"

namespace atlas {

struct WidenOptions {
  double clearance = 0;  // desired clearance in uv units; > 0
  // Bound on the result's stretch (Distortion::stretch_999), or its previous value if that is
  // larger.
  double max_stretch = 1.25;
  double min_altitude = 0;  // as ParamOptions::min_altitude
};

struct Widened {
  double border = 0;                       // length of the border, in uv units
  double near_before = 0, near_after = 0;  // length closer than the clearance
  Distortion distortion;                   // of the result, if anything moved
  bool moved = false;
};

// Measures the border without changing anything.
Widened measure_mesh_gaps(const LocalMesh& mesh, double clearance, std::span<const Vec2d> uvs);

// Moves border vertices that are closer than the clearance to a part that is far away on the
// surface (NearParts) back by half of what is missing. The triangles around them follow without
// flipping, round by round. The best round is kept if its map is injective and within the bound;
// otherwise uvs remain as they are, as they do where nothing is close. The given map must be
// injective. Deterministic.
Widened widen_mesh_gaps(const LocalMesh& mesh, const WidenOptions& options, std::span<Vec2d> uvs);

}  // namespace atlas
