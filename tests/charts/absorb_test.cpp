// Tests which small charts are united with their neighbours once they are flat.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libatlas/charts/flattening/flatten.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {
namespace {

// Returns a grid with its points at place(u, v), where u and v are from 0 to 1.
template <class Place>
Shape bent(int columns, int rows, const Place& place) {
  Shape shape = grid(columns, rows);
  for (Vec3f& p : shape.positions) p = place(double(p.x), double(p.y));
  return shape;
}

// Returns a square patch of the unit sphere that is `angle` (radians) across.
Shape patch(double angle) {
  return bent(6, 6, [=](double u, double v) {
    const double x = angle * (u - 0.5), y = angle * (v - 0.5), r = std::hypot(x, y);
    const double k = r > 0 ? std::sin(r) / r : 1;
    return Vec3f{float(k * x), float(k * y), float(std::cos(r))};
  });
}

FlattenResult flatten(const Shape& shape, std::vector<std::uint32_t> charts,
                      const ChartOptions& options) {
  const Mesh mesh(shape);
  const Result<Topology> topology = build_topology(mesh.view(), {}, {});
  EXPECT_TRUE(topology.ok());
  Partition partition;
  partition.chart = std::move(charts);
  Frames frames;
  return flatten_charts({*topology, {}, options, frames}, partition, {});
}

// Returns the number of charts of a patch that is given as two halves or as one chart.
std::size_t charts_of_patch(double angle, double bound, bool halves, double& stretch_l2) {
  const Shape shape = patch(angle);
  std::vector<std::uint32_t> charts;
  for (std::uint32_t t = 0; t < shape.triangle_count(); ++t) {
    charts.push_back(halves && t / 2 % 6 >= 3);
  }
  ChartOptions options;
  options.max_stretch = bound;
  const FlattenResult result = flatten(shape, charts, options);
  stretch_l2 = result.charts[0].distortion.stretch_l2;
  EXPECT_EQ(result.split_charts(), 0u);
  return result.charts.size();
}

// With a wider bound a seam costs more, and a union may stretch more. With the default bound no
// seam is worth a stretch of 1.01 in charts that stretch less.
TEST(Absorb, AUnionMustBeWorthItsStretch) {
  struct Case {
    double angle, bound;
    std::size_t charts;
  };
  for (const Case& c :
       {Case{0.1, 1.25, 1}, Case{0.5, 1.25, 1}, Case{0.8, 1.25, 1}, Case{1.3, 1.25, 2},
        Case{1.8, 1.25, 2}, Case{1.3, 2, 1}, Case{1.8, 2, 1}, Case{2.3, 2, 1}, Case{2.3, 8, 1}}) {
    double halves = 0, whole = 0;
    EXPECT_EQ(charts_of_patch(c.angle, c.bound, true, halves), c.charts)
        << c.angle << ' ' << c.bound;
    EXPECT_EQ(charts_of_patch(c.angle, c.bound, false, whole), 1u);  // one chart would be possible
    EXPECT_LE(halves, c.bound > 1.25 ? 1.021 : 1.01);
  }
}

// Two flat strips of 5 squares are one chart each, in a mesh of which they are a small part. Side
// by side they fill their rectangle, as an L they fill about a third of it. Returns the number of
// charts that the strips become.
std::size_t charts_of_strips(bool corner, double cone) {
  Shape other = corner ? grid(1, 5, 1, 5) : grid(5, 1, 5, 1);
  for (Vec3f& p : other.positions) p.y += 1;
  Shape shape = together(grid(5, 1, 5, 1), other);
  std::vector<std::uint32_t> charts;
  for (std::uint32_t t = 0; t < shape.triangle_count(); ++t) charts.push_back(t >= 10);
  shape = together(shape, moved(grid(40, 30), 1, {20, 0, 0}));
  charts.resize(shape.triangle_count(), 2);
  ChartOptions options;
  options.cone_degrees = cone;
  return flatten(shape, charts, options).charts.size() - 1;
}

TEST(Absorb, AUnionMustFillItsRectangle) {
  EXPECT_EQ(charts_of_strips(false, 0), 1u);
  EXPECT_EQ(charts_of_strips(true, 0), 2u);
  // With a limit on cones, unions need not fill their rectangles as well.
  EXPECT_EQ(charts_of_strips(false, 30), 1u);
  EXPECT_EQ(charts_of_strips(true, 30), 1u);
}

// A tube with one end closed by a fan. Its rim as a whole fits nowhere along the straight end of
// the flat tube, but it fits along each edge. If the fan is small, it is joined to the tube as a
// petal.
std::size_t charts_of_closed_tube(double length) {
  constexpr int kAround = 8, kAlong = 60;
  Shape shape = cylinder(kAround, kAlong, 1, length);
  std::vector<std::uint32_t> charts(shape.triangle_count(), 0);
  std::vector<std::uint32_t> rim;
  float top = shape.positions[0].z;
  for (const Vec3f& p : shape.positions) top = std::max(top, p.z);
  for (std::uint32_t v = 0; v < shape.positions.size(); ++v) {
    if (shape.positions[v].z == top) rim.push_back(v);
  }
  EXPECT_EQ(rim.size(), std::size_t(kAround));
  const auto angle = [&](std::uint32_t v) {
    return std::atan2(shape.positions[v].y, shape.positions[v].x);
  };
  std::sort(rim.begin(), rim.end(),
            [&](std::uint32_t a, std::uint32_t b) { return angle(a) < angle(b); });
  const auto middle = std::uint32_t(shape.positions.size());
  shape.positions.push_back({0, 0, top});
  for (std::size_t i = 0; i < rim.size(); ++i) {
    shape.indices.insert(shape.indices.end(), {middle, rim[i], rim[(i + 1) % rim.size()]});
    charts.push_back(1);
  }
  return flatten(shape, charts, {}).charts.size();
}

TEST(Absorb, SmallEndsOfTubesBecomePetals) {
  EXPECT_EQ(charts_of_closed_tube(300), 1u);
  EXPECT_EQ(charts_of_closed_tube(3), 2u);
}

}  // namespace
}  // namespace atlas::test
