// Internal: determines which texels of its box belong to a chart that was packed by its outline.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/raster/scan.h"

namespace atlas {

struct OwnershipGrid {
  int width = 0, height = 0;  // size of the box with its pads, texels
  int pad = 1;                // how many texels around every triangle belong to the chart
  int cell = 1;               // side of the cells that the packer assigns, texels
};

// Returns one value per texel of the box, row-major: 1 if the texel lies in a cell that comes
// within `pad` texels of one of the triangles (whose corners are in the box's texels), else 0. If
// the box begins and ends at multiples of `cell`, this is the packer's own rule (pack/outline.h),
// so two charts that were packed by it never own the same texel.
std::vector<std::uint8_t> owned_texels(std::span<const TexelTriangle> triangles,
                                       const OwnershipGrid& grid);

// Returns one value per texel of the box, row-major: its distance to the nearest texel that a
// triangle touches, counted in texels along rows or columns, whichever is more. The value is 65535
// if no touched texel is nearer.
std::vector<std::uint16_t> texels_to_triangles(std::span<const TexelTriangle> triangles,
                                               const OwnershipGrid& grid);

}  // namespace atlas
