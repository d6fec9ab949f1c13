// Internal: finds the triangles that may be seen from their front only, because others lie back to
// back with them.
#pragma once

#include <vector>

#include "libatlas/charts/charted_mesh.h"
#include "libatlas/charts/charts.h"
#include "libatlas/core/context.h"
#include "libatlas/scene/scene.h"

namespace atlas {

// A thin sheet is often modelled as two coincident layers of opposite orientation, each with the
// light of its own side. Drawn from both sides, they would show a mix of both lights. Returns one
// value a triangle of `written`, true where it belongs to such a layer; empty if there is none, or
// if the context is cancelled.
//
// The layers are found in the fine mesh, whose coincident triangles are exactly so: a triangle
// belongs to a layer if triangles of the opposite orientation, which are covered themselves, lie on
// all of it. The layers may have different triangles. A triangle of `written` (of the same charts,
// with uvs of `charts`) belongs to a layer if all fine triangles in its place do, which uvs tell.
// Whoever sees the back of such a triangle therefore sees the front of another one in its place.
std::vector<bool> one_sided_triangles(const Scene& scene, const ChartSet& charts,
                                      const WorldMesh& written, const Context& context);

}  // namespace atlas
