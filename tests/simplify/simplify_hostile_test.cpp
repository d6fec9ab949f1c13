#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <random>

#include "libatlas/core/clock.h"
#include "tests/simplify/exact_slip.h"
#include "tests/simplify/expect_sound.h"
#include "tests/support/slowness.h"

namespace atlas {
namespace {

using namespace simplify_test;

using Vertices = std::vector<ChartedMeshBuilder::Vertex>;

ChartedMeshBuilder::Vertex flat_vertex(double x, double y) {
  return {{static_cast<float>(x), static_cast<float>(y), 0}, {x, y}};
}

TEST(SimplifyHostile, FlippedTriangles) {
  ChartedMesh mesh = box(12);
  std::mt19937 random(3);
  for (std::uint32_t t = 0; t < mesh.triangles(); ++t) {
    if (random() % 3 != 0) continue;
    std::swap(mesh.indices[3 * t + 1], mesh.indices[3 * t + 2]);
    std::swap(mesh.charts.triangle_uv[3 * t + 1], mesh.charts.triangle_uv[3 * t + 2]);
    mesh.charts.flipped_triangles.push_back(t);
  }
  const SimplifiedMesh coarse = simplify(mesh, 100);
  expect_sound(mesh, coarse, 100);
  EXPECT_EQ(coarse.triangles_out, 12U);
}

TEST(SimplifyHostile, TrianglesThatAreListedTwiceStay) {
  ChartedMeshBuilder builder;
  Vertices vertices;
  std::vector<std::uint32_t> triangles;
  constexpr std::uint32_t n = 8;
  for (std::uint32_t j = 0; j <= n; ++j) {
    for (std::uint32_t i = 0; i <= n; ++i) vertices.push_back(flat_vertex(i, j));
  }
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i, b = a + 1, d = a + n + 1, c = d + 1;
      triangles.insert(triangles.end(), {a, b, c, a, c, d});
      if (i == 3 && j == 4) triangles.insert(triangles.end(), {a, b, c});
    }
  }
  builder.add_chart(vertices, triangles);
  const ChartedMesh mesh = builder.build();
  const SimplifiedMesh coarse = simplify(mesh, 10);
  EXPECT_EQ(broken_triangles(mesh, coarse), 0U);
  EXPECT_LT(coarse.triangles_out, mesh.triangles() / 2);
  std::size_t copies = 0;
  for (std::size_t k = 0; k < coarse.indices.size(); k += 3) {
    std::array<Vec3f, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = mesh.positions[coarse.indices[k + i]];
    copies += p == std::array<Vec3f, 3>{{{3, 4, 0}, {4, 4, 0}, {4, 5, 0}}};
  }
  EXPECT_EQ(copies, 2U);
}

TEST(SimplifyHostile, DegenerateTrianglesGoOrStayButDoNotMultiply) {
  ChartedMeshBuilder builder;
  // A strip whose middle row has triangles without area: their corners lie on a line, or two are
  // equal.
  Vertices vertices;
  std::vector<std::uint32_t> triangles;
  constexpr std::uint32_t n = 12;
  for (std::uint32_t i = 0; i <= n; ++i) vertices.push_back(flat_vertex(i, 0));
  for (std::uint32_t i = 0; i <= n; ++i) vertices.push_back(flat_vertex(i, 1));
  for (std::uint32_t i = 0; i <= n; ++i) vertices.push_back(flat_vertex(i, 2));
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = i, b = i + 1, c = i + n + 1, d = c + 1, e = c + n + 1, f = e + 1;
    triangles.insert(triangles.end(), {a, b, c, b, d, c});
    if (i % 4 == 1) {  // adds a vertex on the edge c d, with a triangle without area
      const auto m = static_cast<std::uint32_t>(vertices.size());
      vertices.push_back(flat_vertex(i + 0.5, 1));
      triangles.insert(triangles.end(), {c, d, m, c, m, e, m, d, f, m, f, e});
    } else {
      triangles.insert(triangles.end(), {c, d, f, c, f, e});
    }
    if (i % 5 == 0) triangles.insert(triangles.end(), {c, c, e});
  }
  builder.add_chart(vertices, triangles);
  const ChartedMesh mesh = builder.build();
  const SimplifiedMesh coarse = simplify(mesh, 10);
  EXPECT_EQ(coarse.degenerate_in, 6U);
  EXPECT_EQ(coarse.degenerate_dropped, 3U);
  EXPECT_EQ(coarse.degenerate_kept, 0U);
  EXPECT_EQ(broken_triangles(mesh, coarse), 0U);
  EXPECT_EQ(coarse.triangles_out, 2U);
  EXPECT_NEAR(uv_area(mesh, coarse), 2.0 * n, 1e-9);
}

// A height field of strips. The vertices of each strip hang on the long edges of the strip beside
// it, closed by triangles without area: their uvs lie on a line exactly.
ChartedMesh hanging_strips(int strips, int height, double amplitude) {
  constexpr double kPi = 3.141592653589793;
  const std::uint32_t column = 2 * static_cast<std::uint32_t>(height) + 1;
  Vertices vertices;
  for (int i = 0; i <= strips; ++i) {
    for (std::uint32_t j = 0; j < column; ++j) {
      vertices.push_back(flat_vertex(i, 0.5 * j));
      vertices.back().position.z = static_cast<float>(amplitude * std::sin(3 * kPi * i / strips) *
                                                      std::sin(kPi * 0.5 * j / height));
    }
    for (std::size_t v = vertices.size() - column + 1; v + 1 < vertices.size(); v += 2)
      vertices[v].position.z = 0.5F * (vertices[v - 1].position.z + vertices[v + 1].position.z);
  }
  std::vector<std::uint32_t> triangles;
  for (int i = 0; i < strips; ++i) {
    for (int j = 0; j < height; ++j) {
      const std::uint32_t a = static_cast<std::uint32_t>(i) * column + 2U * j, m = a + 1, b = a + 2,
                          d = a + column, e = d + 2;
      if (i == 0) triangles.insert(triangles.end(), {a, d, b, d, e, b});
      if (i > 0) triangles.insert(triangles.end(), {a, d, m, m, d, e, m, e, b});
      if (i + 1 < strips) triangles.insert(triangles.end(), {d, d + 1, e});
    }
  }
  ChartedMeshBuilder builder;
  builder.add_chart(vertices, triangles);
  return builder.build();
}

// What lay behind a row of such triangles was not measured: the slip was a third above its bound.
TEST(SimplifyHostile, TrianglesWithoutAreaHideNoSlip) {
  constexpr double kDensity = 4;
  SimplifyOptions options;
  options.max_slip_texels = options.max_border_slip_texels = 0.05;
  for (const double amplitude : {0.1, 0.3, 1.0}) {
    const ChartedMesh mesh = hanging_strips(96, 12, amplitude);
    const SimplifiedMesh coarse = simplify(mesh, kDensity, options);
    EXPECT_LE(exact_slip(mesh, coarse, kDensity).inside, coarse.max_slip_texels * (1 + 1e-6))
        << amplitude;
  }
}

TEST(SimplifyHostile, OnlyDegenerateTriangles) {
  ChartedMeshBuilder builder;
  builder.add_chart({flat_vertex(0, 0), flat_vertex(1, 0), flat_vertex(2, 0)}, {0, 1, 2, 1, 1, 2});
  builder.add_chart({flat_vertex(5, 5), flat_vertex(5, 5), flat_vertex(5, 5)}, {0, 1, 2});
  const ChartedMesh mesh = builder.build();
  const SimplifiedMesh coarse = simplify(mesh, 10);
  EXPECT_EQ(coarse.degenerate_in, 3U);
  EXPECT_EQ(coarse.degenerate_kept + coarse.degenerate_dropped, 3U);
  EXPECT_EQ(coarse.triangles_out, coarse.degenerate_kept);
}

// A triangle may lack its area in space only, or in uv only.
TEST(SimplifyHostile, AreasInSpaceAndInUvAreBothNeeded) {
  const Vec3f line[] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}},
              space[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Vec2d flat[] = {{0, 0}, {1, 0}, {2, 0}}, wide[] = {{0, 0}, {1, 0}, {0, 1}};
  for (const int lacking : {0, 1, 2, 3}) {
    Vertices vertices;
    for (int k = 0; k < 3; ++k) {
      vertices.push_back({lacking & 1 ? line[k] : space[k], lacking & 2 ? flat[k] : wide[k]});
    }
    ChartedMeshBuilder builder;
    builder.add_chart(vertices, {0, 1, 2});
    const SimplifiedMesh coarse = simplify(builder.build(), 10);
    EXPECT_EQ(coarse.degenerate_in, lacking ? 1U : 0U) << lacking;
    EXPECT_EQ(coarse.degenerate_kept, lacking ? 1U : 0U) << lacking;
    EXPECT_EQ(coarse.degenerate_dropped, 0U) << lacking;
    EXPECT_EQ(coarse.triangles_out, 1U) << lacking;
  }
}

// A vertex with many neighbours, all of which can be removed before it is.
TEST(SimplifyHostile, AHubInsideGoesOnceItsNeighboursHave) {
  constexpr std::uint32_t n = 400;
  Vertices vertices = {flat_vertex(0, 0)};
  std::vector<std::uint32_t> triangles;
  for (const double radius : {0.5, 1.0}) {
    for (std::uint32_t i = 0; i < n; ++i) {
      // The points lie on a square. Its sides are straight, so the border can be simplified, too.
      const double angle = 2 * 3.14159265358979 * (i + 0.5) / n, x = std::cos(angle),
                   y = std::sin(angle), side = radius / std::max(std::abs(x), std::abs(y));
      vertices.push_back(flat_vertex(side * x, side * y));
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 1 + i, b = 1 + (i + 1) % n, c = a + n, d = b + n;
    triangles.insert(triangles.end(), {0, a, b, a, c, d, a, d, b});
  }
  ChartedMeshBuilder builder;
  builder.add_chart(vertices, triangles);
  const ChartedMesh mesh = builder.build();
  const SimplifiedMesh coarse = simplify(mesh, 100);
  expect_sound(mesh, coarse, 100);
  EXPECT_EQ(std::count(coarse.indices.begin(), coarse.indices.end(), 0u), 0);
  EXPECT_LT(coarse.triangles_out, 20U);
}

TEST(SimplifyHostile, FansThatTouchAtOneVertex) {
  // Two plates of one chart share a single uv; two more share only the position.
  ChartedMeshBuilder builder;
  builder.add_grid(
      16, 16, [](double s, double t) { return flat_vertex(16 * s, 16 * t); },
      [](int i, int j) { return (i < 8) == (j < 8); });
  builder.add_grid(8, 8, [](double s, double t) {
    return ChartedMeshBuilder::Vertex{{8, static_cast<float>(8 + 8 * s), static_cast<float>(4 * t)},
                                      {8 * s, 4 * t}};
  });
  const ChartedMesh mesh = builder.build();
  const SimplifiedMesh coarse = simplify(mesh, 5);
  EXPECT_EQ(broken_triangles(mesh, coarse), 0U);
  EXPECT_LE(coarse.triangles_out, 12U);
  EXPECT_NEAR(uv_area(mesh, coarse), 128 + 32, 1e-9);
}

TEST(SimplifyHostile, RandomSoup) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0, 1);
  ChartedMeshBuilder builder;
  for (int c = 0; c < 60; ++c) {
    Vertices vertices;
    for (int k = 0; k < 3; ++k) {
      const double x = std::round(4 * unit(random)), y = std::round(4 * unit(random));
      vertices.push_back({{static_cast<float>(x), static_cast<float>(y),
                           static_cast<float>(std::round(unit(random)))},
                          {unit(random), unit(random)}});
    }
    builder.add_chart(vertices, {0, 1, 2});
  }
  const ChartedMesh mesh = builder.build();
  const SimplifiedMesh coarse = simplify(mesh, 10);
  EXPECT_EQ(coarse.triangles_out + coarse.degenerate_dropped, mesh.triangles());
}

TEST(SimplifyHostile, FarFromTheOriginAndTiny) {
  // A box of a thousandth, a thousand units away: a float has about sixteen steps over its size.
  const ChartedMesh mesh = box(10, 1.0 / 1024, {1000, 1000, 1000});
  const SimplifiedMesh coarse = simplify(mesh, 1e5);
  EXPECT_LT(coarse.triangles_out, mesh.triangles() * 9 / 10);
  EXPECT_LE(coarse.max_slip_texels, 0.5);
  EXPECT_EQ(open_edges(mesh.positions, coarse.indices).count, 0U);
}

TEST(SimplifyHostile, AFanOfManyTriangles) {
  // A disc with one vertex in the middle and all others on its border.
  constexpr std::uint32_t n = 8000;
  Vertices vertices = {flat_vertex(0, 0)};
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * 3.14159265358979 * i / n;
    vertices.push_back(flat_vertex(std::cos(angle), std::sin(angle)));
    triangles.insert(triangles.end(), {0, 1 + i, 1 + (i + 1) % n});
  }
  ChartedMeshBuilder builder;
  builder.add_chart(vertices, triangles);
  const ChartedMesh mesh = builder.build();
  Stopwatch watch(cpu_seconds);
  const SimplifiedMesh coarse = simplify(mesh, 100);
  // Ranking the hub again after each collapse would take far longer.
  EXPECT_LT(watch.lap(), 0.25 * test::kSlowness);
  EXPECT_EQ(broken_triangles(mesh, coarse), 0U);
  EXPECT_LT(coarse.triangles_out, 500U);
}

TEST(SimplifyHostile, EmptyAndSmall) {
  const ChartedMesh nothing;
  EXPECT_EQ(simplify(nothing, 1).triangles_out, 0U);
  ChartedMeshBuilder builder;
  builder.add_chart({flat_vertex(0, 0), flat_vertex(1, 0), flat_vertex(0, 1)}, {0, 1, 2});
  const ChartedMesh mesh = builder.build();
  EXPECT_EQ(simplify(mesh, 0.001).triangles_out, 1U);
}

TEST(SimplifyHostile, HugeTexelsStillLeaveAMesh) {
  const ChartedMesh mesh = sphere(12);
  const SimplifiedMesh coarse = simplify(mesh, 0.01);
  EXPECT_EQ(broken_triangles(mesh, coarse), 0U);
  EXPECT_EQ(open_edges(mesh.positions, coarse.indices).count, 0U);
  EXPECT_GE(coarse.triangles_out, 6U);
}

// Costs grow with the square of the density, up to the largest float and beyond.
TEST(SimplifyHostile, TinyTexelsEndToo) {
  const ChartedMesh mesh = box(6);
  for (const double density : {1e12, 1e15, 1e18, 1e21, 1e30, 1e160, 1e300}) {
    int rounds = 0;
    std::atomic<bool> cancel{false};
    Context context;
    context.cancel = &cancel;
    context.progress = [&](std::string_view, double) { cancel = ++rounds > 1000; };
    const std::vector<double> densities(6, density);
    const auto coarse = simplify_charts({mesh.view(), mesh.charts, densities}, {}, context);
    ASSERT_TRUE(coarse.ok()) << density;
    EXPECT_EQ(broken_triangles(mesh, *coarse), 0U) << density;
  }
}

TEST(SimplifyHostile, BadOptionsAndInput) {
  const ChartedMesh mesh = box(2);
  const std::vector<double> densities(6, 10);
  const auto code = [&](const SimplifyOptions& options) {
    return simplify_charts({mesh.view(), mesh.charts, densities}, options, {}).status().code();
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {0.0, -1.0, nan}) {
    SimplifyOptions slip, border, turn;
    slip.max_slip_texels = border.max_border_slip_texels = turn.max_turn_degrees = bad;
    EXPECT_EQ(code(slip), ErrorCode::bad_option);
    EXPECT_EQ(code(border), ErrorCode::bad_option);
    EXPECT_EQ(code(turn), ErrorCode::bad_option);
  }
  SimplifyOptions right_angle;
  right_angle.max_turn_degrees = 90;
  EXPECT_EQ(code(right_angle), ErrorCode::bad_option);
  right_angle.max_turn_degrees = 89.99;
  EXPECT_EQ(code(right_angle), ErrorCode::ok);
  const auto with = [](const ChartedMesh& m, const std::vector<double>& d) {
    return simplify_charts({m.view(), m.charts, d}, {}, {}).status().code();
  };
  EXPECT_EQ(with(mesh, {1, 2}), ErrorCode::bad_input);
  EXPECT_EQ(with(mesh, {1, 1, 1, 0, 1, 1}), ErrorCode::bad_input);
  ChartedMesh broken = mesh;
  broken.charts.triangle_uv[5] = 100000;
  EXPECT_EQ(with(broken, densities), ErrorCode::bad_input);
  broken = mesh;
  broken.charts.uv_vertex[3] = 100000;
  EXPECT_EQ(with(broken, densities), ErrorCode::bad_input);
  broken = mesh;
  broken.charts.uvs.pop_back();
  EXPECT_EQ(with(broken, densities), ErrorCode::bad_input);
  broken = mesh;
  broken.charts.charts[5].triangle_count = 1000;
  EXPECT_EQ(with(broken, densities), ErrorCode::bad_input);
  broken = mesh;
  broken.charts.charts[5].uv_count = 1000;
  EXPECT_EQ(with(broken, densities), ErrorCode::bad_input);
  broken = mesh;
  broken.charts.chart_triangles[7] = 100000;
  EXPECT_EQ(with(broken, densities), ErrorCode::bad_input);
  broken = mesh;
  broken.indices.pop_back();
  EXPECT_EQ(with(broken, densities), ErrorCode::bad_input);
}

// Each number is one too large. Behind the ends of the lists lie numbers that would pass.
TEST(SimplifyHostile, InputThatReachesBeyondItsEndByOne) {
  const auto code = [](const ChartedMesh& m) {
    const std::vector<double> densities(m.charts.charts.size(), 10);
    return simplify_charts({m.view(), m.charts, densities}, {}, {}).status().code();
  };
  const ChartedMesh mesh = box(2);
  ASSERT_EQ(code(mesh), ErrorCode::ok);
  ChartedMesh broken = mesh;
  broken.charts.charts[5].triangle_count += 1;
  broken.charts.chart_triangles.push_back(broken.charts.chart_triangles.back());
  broken.charts.chart_triangles.pop_back();
  EXPECT_EQ(code(broken), ErrorCode::bad_input);
  broken = mesh;
  broken.charts.charts[5].uv_count += 1;
  EXPECT_EQ(code(broken), ErrorCode::bad_input);
  broken = mesh;  // the first uv of the next chart
  broken.charts.triangle_uv[0] = broken.charts.charts[1].first_uv;
  EXPECT_EQ(code(broken), ErrorCode::bad_input);
  broken = mesh;  // the last uv of the chart before
  const std::uint32_t last = broken.charts.charts[5].first_triangle;
  broken.charts.triangle_uv[std::size_t{3} * last] = broken.charts.charts[5].first_uv - 1;
  EXPECT_EQ(code(broken), ErrorCode::bad_input);
  broken = mesh;
  broken.charts.uv_vertex[3] = static_cast<std::uint32_t>(broken.positions.size());
  broken.positions.push_back({0, 0, 0});
  broken.positions.pop_back();
  EXPECT_EQ(code(broken), ErrorCode::bad_input);
  broken = mesh;
  broken.charts.chart_triangles[3] = static_cast<std::uint32_t>(mesh.triangles());
  EXPECT_EQ(code(broken), ErrorCode::bad_input);
  broken = mesh;
  broken.charts.flipped_triangles = {static_cast<std::uint32_t>(mesh.triangles())};
  EXPECT_EQ(code(broken), ErrorCode::bad_input);
}

TEST(SimplifyHostile, Cancelled) {
  const ChartedMesh mesh = sphere(24);
  const std::vector<double> densities(6, 50);
  for (const double when : {0.0, 1.0 / 24}) {  // before the first round and after it
    std::atomic<bool> cancel{false};
    Context context;
    context.cancel = &cancel;
    context.progress = [&](std::string_view, double fraction) {
      if (fraction >= when && fraction < 1) cancel = true;
    };
    const auto result = simplify_charts({mesh.view(), mesh.charts, densities}, {}, context);
    ASSERT_TRUE(cancel) << when;
    ASSERT_FALSE(result.ok()) << when;
    EXPECT_EQ(result.status().code(), ErrorCode::cancelled);
  }
}

}  // namespace
}  // namespace atlas
