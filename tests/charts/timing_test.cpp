// The seconds that a chart set reports for its stages.
#include <gtest/gtest.h>

#include "libatlas/charts/charts.h"
#include "libatlas/core/clock.h"
#include "tests/support/shapes.h"

namespace atlas {
namespace {

TEST(ChartTiming, PartsStayWithinTheirSums) {
  const test::Shape shape = test::torus(120, 60);
  MeshView mesh;
  mesh.positions = shape.positions;
  mesh.indices = shape.indices;
  const double start = cpu_seconds();
  const Result<ChartSet> set = make_charts(mesh, {}, {});
  const double spent = cpu_seconds() - start;
  ASSERT_TRUE(set.ok());
  const ChartSet::Timing& t = set->timing;
  const double segmentation[] = {t.topology_cpu, t.noise_cpu,   t.cells_cpu,
                                 t.coarse_cpu,   t.merging_cpu, t.borders_cpu};
  const double parameterization[] = {t.cuts_cpu,     t.solve_cpu,  t.flips_cpu,
                                     t.overlaps_cpu, t.absorb_cpu, t.limbs_cpu};
  double first = 0, second = 0;
  for (const double s : segmentation) first += s;
  for (const double s : parameterization) second += s;
  for (const double s : segmentation) EXPECT_GE(s, 0);
  for (const double s : parameterization) EXPECT_GE(s, 0);
  EXPECT_GT(t.merging_cpu, 0);
  EXPECT_GT(t.solve_cpu, 0);
  EXPECT_LE(first, t.segmentation_cpu * 1.001 + 1e-3);
  // The clocks of the threads and of the process are read at different times.
  EXPECT_LE(second, t.parameterization_cpu * 1.1 + 5e-3);
  EXPECT_GT(first + second, 0.5 * (t.segmentation_cpu + t.parameterization_cpu));
  EXPECT_LE(t.segmentation_cpu + t.parameterization_cpu, spent + 1e-3);
}

}  // namespace
}  // namespace atlas
