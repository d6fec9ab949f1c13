// The pages that charts are packed onto, in the words of every call that packs charts.
#pragma once

#include <cstdint>

#include "libatlas/pack/pack.h"

namespace atlas {

struct PageOptions {
  std::uint32_t pages = 1;        // the most pages to use, >= 1
  std::int32_t page_size = 2048;  // longest side of a page, texels
  // Texels kept free on each side of a chart. Pages that are baked with mip levels 0..M need
  // gutter_pad(M) (uvs/placement.h).
  std::int32_t padding = 2;
  // Boxes and cells of charts begin and end at multiples of this many texels: 4 for textures
  // compressed in blocks, 2^M for mip levels 0..M. A power of two where page sides are.
  std::int32_t alignment = 1;
  bool square = false;         // pages are as wide as high
  bool allow_rotation = true;  // turn charts to pack better; else they lie as their uvs do
  PackPreset preset = PackPreset::standard;
};

}  // namespace atlas
