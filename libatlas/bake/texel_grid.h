// Internal: RGB texels of one chart's box while it is baked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libatlas/core/image.h"
#include "libatlas/texture/lanes.h"

namespace atlas {

struct TexelGrid {
  int width = 0, height = 0;
  std::vector<Lanes> rgb;            // 4th lane unspecified
  std::vector<unsigned char> known;  // 0: no sample came near this texel

  TexelGrid(int w, int h)
      : width(w), height(h), rgb(std::size_t(w) * h), known(std::size_t(w) * h) {}
};

// Fills the unknown texels smoothly from the known ones: pull-push over a pyramid of averages
// (Gortler et al. 1996, section 3.4). Black if nothing is known. Returns how many were filled.
std::size_t fill_unknown(TexelGrid& grid);

// The same for a page of RGB bytes, where `known` is not 0; in a third of the memory of a grid of
// its size.
void fill_unknown(const std::vector<std::uint8_t>& known, Image8& page);

}  // namespace atlas
