// Internal: charts moved by a hair, so that graphics hardware draws no texel of them twice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/core/vec.h"
#include "libatlas/pipeline/assemble_world.h"

namespace atlas {

struct DrawnTwice {
  struct Move {
    std::uint32_t chart = 0;
    Vec2d texels;
  };
  std::size_t before = 0, after = 0;  // texels, of all pages
  std::vector<Move> moves;            // of charts, ascending
};

// Slivers thinner than 1/256 of a texel turn over when they are drawn (chart_drawing.h): where a
// texel's centre happens to lie in one, it is drawn twice, and what is rendered into the page there
// depends on the order of triangles. Such charts are moved by up to a quarter of a texel to where
// no centre is hit, or the fewest are: not over lookups of other charts, and not nearer to the
// page's edge than a texel. `uvs` are those of page_uvs(), rounded; `corners`: 3 a triangle of the
// mesh, into them, counter-clockwise. Once cancelled, charts stay as they are. The result is the
// same for every thread count.
DrawnTwice draw_once(const PlacedCharts& placed, std::span<const std::uint32_t> corners,
                     std::vector<Vec2f>& uvs, const Context& context);

// The same without moving anything: what is drawn twice is counted, and uvs stay as they are.
DrawnTwice drawn_twice(const PlacedCharts& placed, std::span<const std::uint32_t> corners,
                       std::span<const Vec2f> uvs, const Context& context);

}  // namespace atlas
