// Internal: moves charts by fractions of a texel so that graphics hardware draws none of their
// texels twice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/core/vec.h"
#include "libatlas/uvs/page_uvs.h"

namespace atlas {

struct DrawnTwice {
  struct Move {
    std::uint32_t chart = 0;
    Vec2d texels;
  };
  std::size_t before = 0, after = 0;  // texels drawn twice, of all pages
  std::vector<Move> moves;            // ascending by chart
};

// Moves charts so that fewer texels are drawn twice. Slivers thinner than 1/256 of a texel may turn
// over when they are drawn (chart_drawing.h). If a texel's centre happens to lie in such a sliver,
// the texel is drawn twice, and what is rendered into the page there depends on the order of
// triangles. Such charts are moved by up to a quarter of a texel along each axis, to where no
// centre or the fewest are hit. They are moved neither over texels that lookups of other charts
// read nor nearer to the page's edge than a texel; charts that stay are not moved. `uvs` are those
// of page_uvs(), rounded. `corners` are three per triangle of the mesh, indices into `uvs`,
// counter-clockwise. Once cancelled, charts stay as they are. The result is the same for every
// thread count.
DrawnTwice draw_once(const PlacedCharts& placed, std::span<const std::uint32_t> corners,
                     std::vector<Vec2f>& uvs, const Context& context);

// Counts the texels that are drawn twice without moving anything.
DrawnTwice drawn_twice(const PlacedCharts& placed, std::span<const std::uint32_t> corners,
                       std::span<const Vec2f> uvs, const Context& context);

}  // namespace atlas
