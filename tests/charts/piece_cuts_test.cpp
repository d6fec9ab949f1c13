// Which of two cuts of a piece is kept.
#include "libatlas/charts/piece_cuts.h"

#include <gtest/gtest.h>

#include "tests/charts/coarse_shapes.h"
#include "tests/support/shapes.h"

namespace atlas::test {
namespace {

// A strip of squares, each a cell, of which runs of so many are one chart. Seams between charts are
// left out where arcs are joined.
Cut strip(const Topology& topology, std::uint32_t charts, bool joined) {
  Cut cut{topology, {}, {}, {}, {0}};
  cut.cells.count = static_cast<std::uint32_t>(topology.triangle_count() / 2);
  for (std::uint32_t t = 0; t < topology.triangle_count(); ++t)
    cut.cells.of_triangle.push_back(t / 2);
  cut.coarse = build_coarse(topology, 40, cut.cells);
  for (std::uint32_t k = 0; k < cut.cells.count; ++k)
    cut.merged.chart_of_cell.push_back(k < charts ? k : charts - 1);
  cut.merged.joined.assign(cut.coarse.arcs.size(), joined);
  return cut;
}

// Whether a cut into `second` charts is preferred to one into `first`.
bool prefers(std::uint32_t first, std::uint32_t second, bool shorter, bool or_shorter) {
  const Topology topology = topology_of(grid(40, 1, 40, 1));
  Cut a = strip(topology, first, false), b = strip(topology, second, shorter);
  choose(a, b, 0.9, or_shorter);
  EXPECT_NE(a.left_out[0], b.left_out[0]);
  return a.left_out[0] != 0;
}

TEST(PieceCuts, MustSaveAShareOfTheCharts) {
  EXPECT_TRUE(prefers(20, 18, true, true));
  EXPECT_FALSE(prefers(20, 19, true, true));
  EXPECT_FALSE(prefers(20, 21, true, true));
  EXPECT_TRUE(prefers(2, 1, true, false));
}

TEST(PieceCuts, MaySaveSeamsInstead) {
  EXPECT_TRUE(prefers(20, 20, true, true));
  EXPECT_FALSE(prefers(20, 20, false, true));
  EXPECT_FALSE(prefers(20, 20, true, false));
}

}  // namespace
}  // namespace atlas::test
