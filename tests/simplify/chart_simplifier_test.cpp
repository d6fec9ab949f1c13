// Single collapses in one chart, and those along its border.
#include "libatlas/simplify/chart_simplifier.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/simplify/chain_simplifier.h"
#include "tests/simplify/shapes.h"

namespace atlas::simplify_test {
namespace {

using simplify::ChartSimplifier;
using simplify::Collapse;
using simplify::FineChart;
using simplify::Geometry;
using simplify::SlipLimits;

// One chart with texels of length 1, as a simplifier needs it.
class OneChart {
 public:
  OneChart(const ChartedMesh& mesh, const SlipLimits& limits)
      : mesh_(mesh), view_(mesh_.view()), geometry_{&view_, &mesh_.charts} {
    fine_.push_back(simplify::build_fine_chart(geometry_, 0, std::vector<bool>(mesh_.triangles())));
    charts_.push_back(std::make_unique<ChartSimplifier>(geometry_, fine_[0], 1, limits));
  }
  ChartSimplifier& chart() { return *charts_[0]; }
  std::vector<std::unique_ptr<ChartSimplifier>>& charts() { return charts_; }
  const Geometry& geometry() const { return geometry_; }
  simplify::BorderChains chains() const { return simplify::find_border_chains(geometry_, fine_); }
  std::uint32_t at(double u, double v) const {
    for (std::uint32_t i = 0; i < fine_[0].vertex_count(); ++i) {
      if (glm::distance(to_glm(geometry_.uv(fine_[0].vertex_uv[i])), {u, v}) < 1e-9) return i;
    }
    ADD_FAILURE() << "no vertex at " << u << ", " << v;
    return 0;
  }

 private:
  ChartedMesh mesh_;
  MeshView view_;
  Geometry geometry_;
  std::vector<FineChart> fine_;
  std::vector<std::unique_ptr<ChartSimplifier>> charts_;
};

ChartedMesh flat_grid(int n, const ChartedMeshBuilder::Keep& keep = {}) {
  ChartedMeshBuilder builder;
  builder.add_grid(
      n, n,
      [n](double s, double t) {
        return ChartedMeshBuilder::Vertex{{float(n * s), float(n * t), 0}, {n * s, n * t}};
      },
      keep);
  return builder.build();
}

// A straight border of a flat chart: only what the caller says about the border moves anything.
TEST(ChartSimplifier, TheMovementOfTheBorderIsPartOfTheBounds) {
  OneChart one(flat_grid(6), {1, 1});
  ChartSimplifier& chart = one.chart();
  Collapse collapse;
  ASSERT_TRUE(chart.judge(one.at(3, 0), one.at(2, 0), collapse));
  ASSERT_TRUE(chart.check({0.25, 0.125}, collapse));
  ASSERT_FALSE(collapse.bounds.empty());
  for (const SlipLimits& bound : collapse.bounds) EXPECT_NEAR(bound.slip, 0.375, 1e-6);
  chart.apply(collapse);
  EXPECT_NEAR(chart.worst().slip, 0.375, 1e-6);
  // The next step adds to what the triangles have so far.
  ASSERT_TRUE(chart.judge(one.at(4, 0), one.at(5, 0), collapse));
  ASSERT_TRUE(chart.check({0.125, 0.25}, collapse));
  for (const SlipLimits& bound : collapse.bounds) EXPECT_NEAR(bound.slip, 0.625, 1e-6);
  // If the sum exceeds the limit, the slip itself is measured. On this chart it is 0.
  ASSERT_TRUE(chart.judge(one.at(4, 0), one.at(5, 0), collapse));
  ASSERT_TRUE(chart.check({0.875, 0.25}, collapse));
  for (const SlipLimits& bound : collapse.bounds) EXPECT_NEAR(bound.slip, 0, 1e-6);
}

// With a large limit nothing is measured, so the triangles beside the border slip at least as much
// as the border itself.
TEST(ChartSimplifier, TheBoundsBesideABorderContainItsSlip) {
  constexpr int n = 24;
  for (const int wave : {1, 2, 5}) {
    ChartedMeshBuilder builder;
    builder.add_grid(n, n, [=](double s, double t) {
      const double y = n * t + 0.4 * (1 - t) * std::sin(wave * n * s);
      return ChartedMeshBuilder::Vertex{{float(n * s), float(y), 0}, {n * s, y}};
    });
    OneChart one(builder.build(), {1000, 1});
    const double density[] = {1};
    simplify::ChainSimplifier chains(one.geometry(), one.charts(), one.chains(), density);
    chains.set_limits(1, 1);
    chains.run(std::numeric_limits<float>::max(), {});
    EXPECT_GT(chains.worst_slip(), 0.1) << wave;
    EXPECT_LE(chains.worst_slip(), 1 + 1e-6) << wave;
    EXPECT_GE(one.chart().worst().slip, chains.worst_slip() * (1 - 1e-5)) << wave;
  }
}

// The collapse of one side of a hole with three sides would glue the two others to each other.
TEST(ChartSimplifier, AHoleOfThreeSidesDoesNotClose) {
  ChartedMeshBuilder builder;
  std::vector<ChartedMeshBuilder::Vertex> vertices;
  for (const double radius : {1.0, 3.0}) {
    for (int i = 0; i < 3; ++i) {
      const double a = 2 * 3.14159265358979 * i / 3, x = radius * std::cos(a),
                   y = radius * std::sin(a);
      vertices.push_back({{float(x), float(y), 0}, {x, y}});
    }
  }
  builder.add_chart(vertices, {0, 3, 4, 0, 4, 1, 1, 4, 5, 1, 5, 2, 2, 5, 3, 2, 3, 0});
  OneChart one(builder.build(), {1000, 1.5});
  int judged = 0;
  for (std::uint32_t v = 0; v < 3; ++v) {
    for (std::uint32_t w = 0; w < 3; ++w) {
      const auto corner = [&](std::uint32_t i) {
        return one.at(vertices[i].uv.x, vertices[i].uv.y);
      };
      Collapse collapse;
      if (v == w || !one.chart().judge(corner(v), corner(w), collapse)) continue;
      ++judged;
      EXPECT_FALSE(one.chart().check({}, collapse)) << v << ' ' << w;
    }
  }
  EXPECT_GT(judged, 0);
}

// A flat disk with n vertices on its border.
ChartedMesh disk(std::uint32_t n, std::uint32_t rings) {
  std::vector<ChartedMeshBuilder::Vertex> vertices = {{{0, 0, 0}, {0, 0}}};
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t r = 0; r < rings; ++r) {
    // The innermost ring has few vertices, and each ring has twice as many as the one before.
    const std::uint32_t here = n >> (rings - 1 - r);
    const double radius = 100.0 * (r + 1) / rings;
    for (std::uint32_t i = 0; i < here; ++i) {
      const double a = 2 * 3.14159265358979 * i / here, x = radius * std::cos(a),
                   y = radius * std::sin(a);
      vertices.push_back({{float(x), float(y), 0}, {x, y}});
    }
  }
  const std::uint32_t least = n >> (rings - 1);
  for (std::uint32_t i = 0; i < least; ++i) {
    triangles.insert(triangles.end(), {0, 1 + i, 1 + (i + 1) % least});
  }
  std::uint32_t first = 1, next = 1 + least;
  for (std::uint32_t r = 0; r + 1 < rings; ++r) {
    const std::uint32_t here = next - first, there = n >> (rings - 2 - r);
    for (std::uint32_t i = 0; i < there; ++i) {
      const std::uint32_t inner = std::min(i * here / there, here - 1),
                          inner_next = (i + 1) * here / there % here, a = first + inner,
                          b = first + inner_next, c = next + i, d = next + (i + 1) % there;
      triangles.insert(triangles.end(), {a, c, d});
      if (a != b) triangles.insert(triangles.end(), {a, d, b});
    }
    first = next;
    next += there;
  }
  ChartedMeshBuilder builder;
  builder.add_chart(vertices, triangles);
  return builder.build();
}

// The border stays here, and without a limit some vertices would become neighbours of very many
// others.
TEST(ChartSimplifier, NoVertexGetsVeryManyNeighbours) {
  const ChartedMesh mesh = disk(4096, 9);
  OneChart one(mesh, {0.5, 1});
  one.chart().run(std::numeric_limits<float>::max(), {});
  std::vector<ChartSimplifier::Triangle> left;
  one.chart().collect(left);
  std::vector<std::size_t> count(mesh.charts.uvs.size(), 0);
  for (const auto& t : left) {
    for (const std::uint32_t v : t.vertices) ++count[v];
  }
  EXPECT_LT(left.size(), mesh.triangles() / 2);
  EXPECT_LE(*std::max_element(count.begin(), count.end()), 96U);
}

}  // namespace
}  // namespace atlas::simplify_test
