// Internal: which texels of its box belong to a chart that was packed by its outline.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/raster/scan.h"

namespace atlas {

struct OwnershipGrid {
  int width = 0, height = 0;  // of the box with its pads, texels
  int pad = 1;                // texels around every triangle that belong to the chart
  int cell = 1;               // texels a side of the cells that the packer hands out
};

// 1 a texel of the box, row-major: whether it lies in a cell that comes within `pad` texels of one
// of the triangles (in the box's texels). Where the box begins and ends at multiples of `cell`,
// this is the packer's own rule (pack/outline.h), so texels of two charts packed by it never meet.
std::vector<std::uint8_t> owned_texels(std::span<const TexelTriangle> triangles,
                                       const OwnershipGrid& grid);

// 1 a texel of the box, row-major: how many texels it is from the nearest one that a triangle
// touches, along rows or columns, whichever is more; 65535 where none is nearer.
std::vector<std::uint16_t> texels_to_triangles(std::span<const TexelTriangle> triangles,
                                               const OwnershipGrid& grid);

}  // namespace atlas
