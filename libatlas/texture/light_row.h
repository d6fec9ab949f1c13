// Internal: processes many samples of one row at once, in vectors as wide as the processor has. The
// results are the same, bit by bit, as those of one sample after another.
#pragma once

#include "libatlas/core/lanes.h"
#include "libatlas/core/vec.h"
#include "libatlas/texture/texture_levels.h"

namespace atlas {

// The positions at + (first + i) * step in a texture, in texels of the level.
struct TextureRow {
  const TextureLevels::Level& level;
  TextureWraps wraps;
  Vec2f at, step;
  int first = 0;
};

// Multiplies colours[i], 0 <= i < n, by the result of look_up() at position i.
void multiply_by_texture(const TextureRow& row, int n, Lanes* colours);

// Replaces colours[i], 0 <= i < n, by srgb_encode_lanes(scale * colours[i]).
void srgb_encode_row(float scale, int n, Lanes* colours);

}  // namespace atlas
