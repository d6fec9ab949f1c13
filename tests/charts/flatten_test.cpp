// Flattens one given chart: as it is, slit open, or divided.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/charts/mesh/noise.h"
#include "tests/charts/chart_checks.h"
#include "tests/charts/whole_chart.h"

namespace atlas::test {
namespace {

// A wall around the z axis that bulges, so that it does not unroll exactly. It has `around` edges,
// and the radius `bottom` at its lower hole.
Shape bottle(int around, int along, double bottom) {
  Shape shape;
  shape.name = "bottle";
  for (int j = 0; j <= along; ++j) {
    const double z = 2.0 * j / along, radius = bottom + 0.4 * z + 0.06 * std::sin(M_PI * z);
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * M_PI * i / around;
      shape.positions.push_back(
          {float(radius * std::cos(angle)), float(radius * std::sin(angle)), float(z)});
    }
  }
  const auto at = [&](int i, int j) { return std::uint32_t(j * around + i % around); };
  for (int j = 0; j < along; ++j) {
    for (int i = 0; i < around; ++i) {
      shape.indices.insert(shape.indices.end(), {at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      shape.indices.insert(shape.indices.end(), {at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return shape;
}

void expect_whole(const FlattenResult& result, const Shape& shape, double bound) {
  std::vector<int> seen(shape.triangle_count(), 0);
  for (const FlatChart& chart : result.charts) {
    for (const std::uint32_t t : chart.triangles) ++seen[t];
    EXPECT_EQ(chart.distortion.flips, 0u) << shape.name;
    EXPECT_LE(chart.distortion.stretch_999, bound) << shape.name;
    EXPECT_LE(chart.distortion.stretch_l2, bound) << shape.name;
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), std::ptrdiff_t(seen.size())) << shape.name;
}

TEST(Flatten, WallsAroundSmallHolesAreSlitNotDivided) {
  for (const int around : {7, 12, 16}) {
    for (const int along : {6, 20}) {
      for (const double bottom : {0.02, 0.1}) {
        const Shape shape = bottle(around, along, bottom);
        const FlattenResult result = flatten_whole(shape);
        expect_whole(result, shape, 1.25);
        EXPECT_EQ(result.split_charts(), 0u) << around << ' ' << along << ' ' << bottom;
        EXPECT_EQ(result.charts.size(), 1u) << around << ' ' << along << ' ' << bottom;
      }
    }
  }
}

TEST(Flatten, ClosedAndFoldedSurfacesEndWithinTheBound) {
  for (const Shape& shape : {box(3), icosphere(2), torus(24, 12), noisy(icosphere(2), 0.05, 3),
                             noisy_along_normals(torus(40, 24), 0.3)}) {
    for (const double bound : {1.1, 1.25, 2.0, 3.0}) {
      ChartOptions options;
      options.max_stretch = bound;
      expect_whole(flatten_whole(shape, options), shape, bound);
    }
  }
}

// The pieces are large enough to distinguish noise from the effect of few triangles.
TEST(Noise, IsFoundOnSomeHundredTriangles) {
  const auto calmed = [](const Shape& shape) {
    const Mesh mesh(shape);
    Result<Topology> topology = build_topology(mesh.view(), {}, {});
    EXPECT_TRUE(topology.ok());
    calm_noise(*topology, {});
    return !topology->calm_normals.empty();
  };
  for (const int n : {7, 10, 20}) {
    const Shape smooth = geodesic_sphere(n);
    EXPECT_FALSE(calmed(smooth)) << n;
    EXPECT_TRUE(calmed(noisy_along_normals(smooth, 0.15))) << n;
  }
  EXPECT_FALSE(calmed(noisy_along_normals(geodesic_sphere(3), 0.15)));
}

TEST(Noise, IsTakenFromTheNormalsOfItsPieceOnly) {
  const Shape smooth = geodesic_sphere(7), rough = noisy_along_normals(geodesic_sphere(10), 0.15);
  const Topology topology = topology_of(Mesh(together(smooth, moved(rough, 1, {3, 0, 0}))));
  ASSERT_EQ(topology.calm_normals.size(), topology.triangle_count());
  for (std::uint32_t t = 0; t < topology.triangle_count(); ++t)
    ASSERT_EQ(topology.calm_normals[t] == topology.normals[t], t < smooth.triangle_count()) << t;
}

}  // namespace
}  // namespace atlas::test
