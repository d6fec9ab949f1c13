// Writes values at the vertices of unwrapped meshes into the texels of their pages: colours of a
// scan, or whatever else a texture is to show.
#pragma once

#include <cstdint>
#include <span>

#include "libatlas/core/context.h"
#include "libatlas/core/image.h"
#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"
#include "libatlas/unwrap/atlas.h"

namespace atlas {

struct TransferOptions {
  std::uint32_t page = 0;   // into UnwrappedMesh::pages
  std::int32_t shifts = 4;  // samples a texel, 1..64; rounded up to a square
};

// Returns three channels of a page. `values` has one element a vertex of unwrapped.all(), finite;
// triangles interpolate between their corners. The texels are those whose bilinear interpolation is
// nearest to that over each chart, in the least squares sense (docs/bake.md), within the range of
// the values. Texels beside charts are filled from the nearest ones, so that mip levels and lookups
// at borders are right, too. Charts must lie two texels apart, as they do with any padding above 0;
// of texels that two charts claim, the one with the lower number gets them. The result is the same
// for every thread count.
// Errors: bad_input (the number of values, or one that is not finite); bad_option; cancelled.
Result<ImageF> transfer(const UnwrappedAtlas& unwrapped, std::span<const Vec3f> values,
                        const TransferOptions& options, const Context& context);

}  // namespace atlas
