// Internal: meshes that lie in a rectangle of their own each, so that a copy of the rectangle is
// all that another instance of a mesh takes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/unwrap/instance.h"
#include "libatlas/unwrap/unwrap.h"

namespace atlas {

// A mesh and the relative densities of its instances, at least one, each finite and > 0.
struct BlockMesh {
  MeshView mesh = {};
  std::span<const float> densities = {};
};

struct Blocks {
  std::vector<UnwrappedMesh> meshes = {};                 // each on a page of its own
  std::vector<std::vector<MeshInstance>> instances = {};  // of each mesh
  std::vector<std::vector<Rect>> rects = {};              // likewise, on their pages
  std::vector<Extent> pages = {};
  double texels_per_unit = 0;
  double utilization = 0;  // area of all instances' charts / area of the pages
};

// Unwraps each mesh at the density of its coarsest instance, where charts are the padding apart,
// and packs a rectangle for each instance. Rectangles are not turned. If they do not fit, or could
// be larger with texels_per_unit 0, that is done again at another common density. Errors: those of
// unwrap_mesh().
Result<Blocks> unwrap_blocks(std::span<const BlockMesh> meshes, const UnwrapOptions& options,
                             const Context& context);

}  // namespace atlas
