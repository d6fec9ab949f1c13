// Internal: moves parts of a given chart's border apart that touch each other.
#pragma once

#include <span>

#include "libatlas/core/vec.h"
#include "libatlas/param/local_mesh.h"

namespace atlas {

// Where a border touches itself, as it does at vertices that lie on an edge of the same chart, the
// rounding of uvs decides whether its triangles overlap. Moves the vertices there apart, by a few
// hundred-thousandths of `width` (the square root of the chart's uv area) at most. Returns whether
// the map is injective then, as it may have been before; if not, the uvs are of no use.
bool part_touching(const LocalMesh& mesh, double width, std::span<Vec2d> uvs);

}  // namespace atlas
