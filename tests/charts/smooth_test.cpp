// Single triangles move between charts until no border gets shorter.
#include <gtest/gtest.h>

#include <cmath>

#include "libatlas/charts/seams/refine.h"
#include "tests/charts/ragged_charts.h"

namespace atlas::test {
namespace {

constexpr double kNoCrease = 180;

std::vector<Shape> shapes() {
  return {grid(24, 24), sphere(32, 16), torus(40, 14), plate_with_holes(2, 4),
          noisy(icosphere(3), 0.02, 5)};
}

void smooth(RaggedCharts& charts, const ConeLimit& cone = {}) {
  smooth_borders(charts.topology, {kNoCrease, cone}, charts.partition, charts.frames);
}

TEST(Smooth, ChartsStayConnectedAndBordersGetShorter) {
  for (const Shape& shape : shapes()) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      RaggedCharts charts(shape);
      charts.grow(4 + std::uint32_t(seed), seed);
      const double before = charts.border_length();
      smooth(charts);
      EXPECT_LT(charts.border_length(), before) << shape.name << ' ' << seed;
      for (const auto& [chart, pieces_and_euler] : charts.topologies())
        EXPECT_EQ(pieces_and_euler.first, 1u) << shape.name << ' ' << seed << ' ' << chart;
    }
  }
}

// Creases attract borders, which must not tear charts either.
TEST(Smooth, ChartsStayConnectedAtCreases) {
  for (const Shape& shape : {box(8), noisy(icosphere(3), 0.05, 5), noisy(grid(24, 24), 0.03, 2)}) {
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      RaggedCharts charts(shape);
      charts.grow(4 + std::uint32_t(seed), seed);
      smooth_borders(charts.topology, {15, {}}, charts.partition, charts.frames);
      for (const auto& [chart, pieces_and_euler] : charts.topologies())
        EXPECT_EQ(pieces_and_euler.first, 1u) << shape.name << ' ' << seed << ' ' << chart;
    }
  }
}

// What may go is judged around one triangle. At the border of a disc that is exact: the rest is a
// disc, too. Triangles inside stay.
TEST(Smooth, TrianglesMayGoIfTheRestOfADiscIsADisc) {
  std::size_t discs = 0, may = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    RaggedCharts charts(seed % 2 ? grid(8, 8) : icosphere(2));
    charts.grow(5, seed);
    const auto disc = std::pair<std::uint32_t, int>{1, 1};
    const auto topologies = charts.topologies();
    for (std::uint32_t t = 0; t < charts.topology.triangle_count(); ++t) {
      const std::uint32_t own = charts.partition.chart[t];
      if (topologies.at(own) != disc) continue;
      ++discs;
      bool inside = true;
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t o = charts.topology.opposite[h];
        inside = inside && o != kNoIndex && charts.partition.chart[o / 3] == own;
      }
      charts.partition.chart[t] = kNoIndex - 1;
      const auto rest = charts.topologies();
      charts.partition.chart[t] = own;
      const bool may_go = removable(charts.topology, charts.partition, t);
      EXPECT_EQ(may_go, !inside && (!rest.contains(own) || rest.at(own) == disc)) << seed << t;
      may += may_go;
    }
  }
  EXPECT_GT(may, 100u);
  EXPECT_GT(discs, may + 100);
}

// A triangle takes no seam along, and leaves none.
TEST(Smooth, SeamsHaveTwoSidesInOneChart) {
  for (const Shape& shape : shapes()) {
    RaggedCharts charts(shape);
    charts.grow(8, 3);
    charts.cut_at_random(5, 4);
    smooth(charts);
    EXPECT_EQ(charts.seam_faults(), 0u) << shape.name;
  }
}

TEST(Smooth, NoTriangleGoesWhereTheConeExcludesIt) {
  constexpr double kLeastCosine = 0.8;
  std::size_t moved = 0;
  for (const Shape& shape : {sphere(32, 16), torus(40, 14), noisy(icosphere(3), 0.02, 5)}) {
    RaggedCharts charts(shape);
    charts.grow(12, 7);
    const std::vector<std::uint32_t> before = charts.partition.chart;
    std::vector<Vec3f> axes(12, Vec3f{0, 0, 1});
    for (std::size_t t = before.size(); t-- > 0;) axes[before[t]] = charts.topology.normals[t];
    smooth(charts, {axes, kLeastCosine});
    for (std::size_t t = 0; t < before.size(); ++t) {
      const std::uint32_t now = charts.partition.chart[t];
      if (now == before[t]) continue;
      ++moved;
      EXPECT_GE(glm::dot(to_dvec(charts.topology.normals[t]), to_dvec(axes[now])), kLeastCosine);
    }
  }
  EXPECT_GT(moved, 20u);
}

// In a plane, a triangle that moves takes over the map of its new chart as it is.
TEST(Smooth, TrianglesTakeTheMapOfTheirNewChart) {
  RaggedCharts charts(grid(24, 24));
  charts.grow(9, 5);
  const auto map_of = [](std::uint32_t chart) {
    const auto c = float(std::cos(0.6 * chart)), s = float(std::sin(0.6 * chart));
    return Frames::Frame{Vec3f{c, s, 0}, Vec3f{-s, c, 0}};
  };
  const std::vector<std::uint32_t> before = charts.partition.chart;
  for (std::uint32_t t = 0; t < before.size(); ++t) charts.frames.put(t, map_of(before[t]));
  smooth(charts);
  EXPECT_NE(charts.partition.chart, before);
  for (std::uint32_t t = 0; t < before.size(); ++t) {
    const Frames::Frame frame = charts.frames.at(charts.topology, t),
                        wanted = map_of(charts.partition.chart[t]);
    for (int row = 0; row < 2; ++row) {
      ASSERT_NEAR(frame[row].x, wanted[row].x, 1e-5);
      ASSERT_NEAR(frame[row].y, wanted[row].y, 1e-5);
    }
  }
}

}  // namespace
}  // namespace atlas::test
