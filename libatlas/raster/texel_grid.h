// Internal: RGB texels, of which some are not known yet: those of a chart's box while it is baked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libatlas/core/image.h"
#include "libatlas/core/lanes.h"

namespace atlas {

struct TexelGrid {
  int width = 0, height = 0;
  std::vector<Lanes> rgb;            // the 4th lane is unspecified
  std::vector<unsigned char> known;  // 0 if no sample came near this texel

  TexelGrid(int w, int h)
      : width(w), height(h), rgb(std::size_t(w) * h), known(std::size_t(w) * h) {}
};

// Fills the unknown texels smoothly from the known ones by pull-push over a pyramid of averages
// (Gortler et al. 1996, section 3.4). If no texel is known, all become black. Returns how many
// texels were filled.
std::size_t fill_unknown(TexelGrid& grid);

// Does the same for a page of RGB bytes, where texels are unknown if `known` is 0. This takes a
// third of the memory of a TexelGrid of that size.
void fill_unknown(const std::vector<std::uint8_t>& known, Image8& page);

}  // namespace atlas
