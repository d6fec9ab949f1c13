#include "tests/simplify/expect_sound.h"

#include <gtest/gtest.h>

namespace atlas::simplify_test {

SimplifiedMesh simplify(const ChartedMesh& mesh, double density, const SimplifyOptions& options,
                        const Context& context) {
  const std::vector<double> densities(mesh.charts.charts.size(), density);
  auto result = simplify_charts({mesh.view(), mesh.charts, densities}, options, context);
  EXPECT_TRUE(result.ok()) << result.status().message();
  return result.ok() ? std::move(*result) : SimplifiedMesh{};
}

void expect_sound(const ChartedMesh& mesh, const SimplifiedMesh& coarse, double density,
                  const SimplifyOptions& options) {
  expect_sound(mesh, coarse, std::vector<double>(mesh.charts.charts.size(), density), options);
}

void expect_sound(const ChartedMesh& mesh, const SimplifiedMesh& coarse,
                  std::span<const double> densities, const SimplifyOptions& options) {
  EXPECT_EQ(coarse.triangles_in, mesh.triangles());
  EXPECT_EQ(coarse.triangles_out, coarse.triangle_chart.size());
  EXPECT_EQ(coarse.source_triangle.size(), coarse.triangle_chart.size());
  ASSERT_EQ(coarse.indices.size(), 3 * coarse.triangle_chart.size());
  ASSERT_EQ(coarse.uv_indices.size(), coarse.indices.size());
  EXPECT_EQ(broken_triangles(mesh, coarse), 0U);
  const OpenEdges before = open_edges(mesh.positions, mesh.indices),
                  after = open_edges(mesh.positions, coarse.indices);
  EXPECT_LE(after.count, before.count);
  // They may be shorter, because borders with different steps along one line may come to match.
  EXPECT_LE(after.length, before.length * 1.001);

  const SampledSlip slip = sample_slip(mesh, coarse, densities, coarse.max_turn_degrees);
  EXPECT_LE(slip.inside, coarse.max_slip_texels + 1e-6);
  EXPECT_LE(slip.outside, options.max_slip_texels);
  EXPECT_LE(slip.turned_share, 1e-3);
  EXPECT_LE(coarse.max_slip_texels, options.max_slip_texels);
  EXPECT_LE(coarse.max_turn_degrees, options.max_turn_degrees);
}

}  // namespace atlas::simplify_test
