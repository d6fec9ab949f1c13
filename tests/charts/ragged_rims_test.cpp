// Limbs of charts with ragged rims are looked for in limited time.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

#include "libatlas/charts/filling/limb_cutter.h"
#include "libatlas/core/clock.h"
#include "tests/charts/chart_checks.h"
#include "tests/charts/flat_shape.h"
#include "tests/support/slowness.h"

namespace atlas::test {
namespace {

// A flat fan of n triangles, n/2 teeth: every other corner lies at `outer` instead of 1.
Shape saw(int n, float outer) {
  Shape shape = fan(n);
  for (std::size_t i = 1; i < shape.positions.size(); ++i) {
    Vec3f& p = shape.positions[i];
    const float radius = (i % 2 == 0 ? outer : 1) / std::hypot(p.x, p.y);
    p.x *= radius;
    p.y *= radius;
  }
  return shape;
}

// Returns the CPU seconds of the fastest run, which other work on the machine slows least.
double seconds(const Shape& shape, int runs) {
  const Mesh mesh(shape);
  Context one;
  one.threads = 1;
  double least = std::numeric_limits<double>::infinity();
  for (int run = 0; run < runs; ++run) {
    const double begun = cpu_seconds();
    const Result<ChartSet> set = make_charts(mesh.view(), {}, one);
    least = std::min(least, cpu_seconds() - begun);
    EXPECT_TRUE(set.ok());
    EXPECT_EQ(set->charts.size(), 1u);
  }
  return least;
}

TEST(RaggedRims, TakeLittleLongerThanSmoothOnes) {
  const double smooth = seconds(saw(40000, 1), 2), ragged = seconds(saw(40000, 1.5f), 2);
  EXPECT_LT(ragged, 40 * smooth) << smooth;
  EXPECT_LT(ragged, 2 * kSlowness);
  // Four times as many teeth take about four times as long, with a quadratic search sixteen times.
  EXPECT_LT(ragged, 6 * seconds(saw(10000, 1.5f), 1));
}

// Returns a fan around the origin, which is corner 0 of its triangles, with its area.
FlatChart flat(const Shape& shape) {
  FlatChart chart = as_it_lies(shape);
  for (const auto& corner : chart.corners) {
    const Vec3f &b = shape.positions[corner[1]], &c = shape.positions[corner[2]];
    chart.distortion.uv_area += (b.x * c.y - b.y * c.x) / 2;
  }
  return chart;
}

TEST(RaggedRims, TheSearchForLimbsEndsSoonAfterItIsCancelled) {
  const FlatChart chart = flat(saw(80000, 1.5f));
  for (const int wait : {0, 30, 100, 300}) {  // milliseconds
    std::atomic<bool> cancel{wait == 0};
    Context context;
    context.cancel = &cancel;
    std::atomic<double> cancelled_at{cpu_seconds()};
    std::thread canceller([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(wait));
      cancelled_at = cpu_seconds();
      cancel = true;
    });
    const double area = chart.distortion.uv_area;
    EXPECT_TRUE(limbs_of(chart, {0.72, area}, context).empty());
    canceller.join();
    EXPECT_LT(cpu_seconds() - cancelled_at, 0.2 * kSlowness) << wait;
  }
}

}  // namespace
}  // namespace atlas::test
