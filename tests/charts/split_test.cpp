// Where charts that fail are divided, and what joins around sharp points.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "libatlas/charts/flattening/split.h"
#include "tests/charts/chart_checks.h"
#include "tests/charts/whole_chart.h"

namespace atlas::test {
namespace {

// A strip of squares along x, as one chart.
struct Strip : Whole {
  explicit Strip(int length) : Whole(grid(length, 2, float(length), 2)) {
    chart.build(topology, partition, triangles);
  }
  float x(std::uint32_t t) const {
    float sum = 0;
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h)
      sum += topology.points[topology.corner_vertex[h]].x / float(3 * topology.scale);
    return sum;
  }

  LocalChart chart;
};

TEST(Halves, MeetHalfwayOrInTheMiddleOfTheOffenders) {
  const Strip strip(40);
  const auto n = std::uint32_t(strip.topology.triangle_count());
  for (const float middle : {4.f, 13.f, 31.f, -1.f}) {
    std::vector<std::uint32_t> offenders;
    for (std::uint32_t t = 0; t < n; ++t)
      if (std::abs(strip.x(t) - middle) < 2) offenders.push_back(t);
    if (middle < 0) offenders.clear();
    const std::vector<std::uint8_t> parts = halves(strip.topology, strip.chart, offenders);
    const float border = middle < 0 ? 20 : middle;
    for (std::uint32_t t = 0; t < n; ++t) {
      if (std::abs(strip.x(t) - border) < 2) continue;  // the border is not straight
      EXPECT_EQ(parts[t] == parts[0], (strip.x(t) < border) == (strip.x(0) < border)) << t;
    }
  }
}

// A wall with n x n recessed windows, which all but the corners of the recesses unroll around.
Shape facade(int n) {
  Shape shape;
  shape.name = "facade";
  std::map<std::array<float, 3>, std::uint32_t> known;
  const auto at = [&](float x, float y, float z) {
    const auto [it, fresh] = known.try_emplace({x, y, z}, std::uint32_t(known.size()));
    if (fresh) shape.positions.push_back({x, y, z});
    return it->second;
  };
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    shape.indices.insert(shape.indices.end(), {a, b, c, a, c, d});
  };
  constexpr std::array lines{0.f, 0.25f, 0.75f, 1.f};
  constexpr float depth = -0.07f;
  for (int i = 0; i < n * n; ++i) {
    const auto x = [&](int k) { return float(i % n) + lines[std::size_t(k)]; };
    const auto y = [&](int k) { return float(i / n) + lines[std::size_t(k)]; };
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        const float z = a == 1 && b == 1 ? depth : 0;
        quad(at(x(a), y(b), z), at(x(a + 1), y(b), z), at(x(a + 1), y(b + 1), z),
             at(x(a), y(b + 1), z));
      }
    constexpr std::array<std::array<int, 2>, 5> around{{{1, 1}, {2, 1}, {2, 2}, {1, 2}, {1, 1}}};
    for (std::size_t k = 0; k < 4; ++k) {
      const auto [ax, ay] = around[k];
      const auto [bx, by] = around[k + 1];
      quad(at(x(ax), y(ay), 0), at(x(bx), y(by), 0), at(x(bx), y(by), depth),
           at(x(ax), y(ay), depth));
    }
  }
  return shape;
}

// Panes and reveals are joined to crosses, though around the corners between them nothing is flat.
TEST(SharpPoints, WindowsBecomeCrosses) {
  const ChartSet set = checked_charts(Mesh(facade(4)));
  EXPECT_EQ(set.charts.size(), 17u);
  EXPECT_LT(set.distortion.stretch_l2, 1 + 1e-9);
  const ChartSet cube = checked_charts(Mesh(box(1)));
  EXPECT_LE(cube.charts.size(), 2u);
  EXPECT_LT(cube.distortion.stretch_l2, 1 + 1e-9);
}

}  // namespace
}  // namespace atlas::test
