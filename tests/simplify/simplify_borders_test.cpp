// What becomes of borders: their own bounds, and where they must stay.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/simplify/exact_slip.h"
#include "tests/simplify/expect_sound.h"

namespace atlas {
namespace {

using namespace simplify_test;
using Vertex = ChartedMeshBuilder::Vertex;

struct Ragged {
  double roughness = 0.01;  // of the four sides, in the plane
  double bumps = 0;         // heights above the plane
  bool fold = false;        // a second chart hangs from one side, which is then a seam
};

// A grid whose four sides are wavy and rough.
ChartedMesh ragged(std::uint32_t seed, const Ragged& shape) {
  constexpr int n = 40, m = 12;
  const auto rough = [=](int i, std::uint32_t side) {
    std::mt19937 random(seed * 7919 + side * 104729 + static_cast<std::uint32_t>(i));
    return shape.roughness *
           (0.4 * std::sin(0.3 * i + side + seed) + double(random() % 1000) / 1000);
  };
  const auto place = [=](double s, double t) {
    const int i = static_cast<int>(std::lround(s * n)), j = static_cast<int>(std::lround(t * m));
    const double x = 4 * s + (1 - s) * rough(j, 0) + s * rough(j, 1),
                 y = t + (1 - t) * rough(i, 2) + t * rough(i, 3);
    return Vec2d{static_cast<float>(x), static_cast<float>(y)};
  };
  const auto height = [=](double s, double t) {
    std::mt19937 random(seed * 31 + static_cast<std::uint32_t>(std::lround(1000 * s + 77777 * t)));
    return float(shape.bumps * (std::sin(3 * s + 2 * t) + 0.1 * double(random() % 1000) / 1000));
  };
  ChartedMeshBuilder builder;
  builder.add_grid(n, m, [&](double s, double t) {
    const Vec2d p = place(s, t);
    return Vertex{{float(p.x), float(p.y), height(s, t)}, p};
  });
  if (shape.fold) {  // a flat wall would not follow the rough side, so this one is bent like it
    double along[n + 1] = {};
    for (int i = 1; i <= n; ++i) {
      const Vec2d p = place(double(i - 1) / n, 0), q = place(double(i) / n, 0);
      along[i] = along[i - 1] + std::hypot(q.x - p.x, q.y - p.y);
    }
    builder.add_grid(n, m, [&](double s, double t) {
      const Vec2d p = place(s, 0);
      const double u = along[std::lround(s * n)];
      return Vertex{{float(p.x), float(p.y), float(height(s, 0) + t - 1)}, {u, t}};
    });
  }
  return builder.build();
}

TEST(SimplifyBorders, AnOpenBorderKeepsItsOwnBound) {
  constexpr double kDensity = 20;
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const ChartedMesh mesh = ragged(seed, {});
    std::size_t last = mesh.triangles() + 1;
    for (const double bound : {0.02, 0.1, 0.4}) {
      SimplifyOptions options;
      options.max_border_slip_texels = bound;
      const SimplifiedMesh coarse = simplify(mesh, kDensity, options);
      const ExactSlip exact = exact_slip(mesh, coarse, kDensity);
      EXPECT_LE(exact.border, bound + 1e-6) << seed;
      EXPECT_LE(exact.border, coarse.max_slip_texels + 1e-6) << seed;
      EXPECT_LE(exact.inside, coarse.max_slip_texels + 1e-6) << seed;
      EXPECT_LT(coarse.triangles_out, last) << seed;
      last = coarse.triangles_out;
    }
  }
}

TEST(SimplifyBorders, AnOpenBorderKeepsTheBoundOfTheInsideToo) {
  const ChartedMesh mesh = ragged(3, {});
  for (const double slip : {0.1, 0.3}) {
    SimplifyOptions equal, above;
    equal.max_slip_texels = equal.max_border_slip_texels = above.max_slip_texels = slip;
    above.max_border_slip_texels = 5;
    const SimplifiedMesh coarse = simplify(mesh, 20, above);
    EXPECT_EQ(coarse.uv_indices, simplify(mesh, 20, equal).uv_indices);
    EXPECT_LE(exact_slip(mesh, coarse, 20).border, slip + 1e-6);
  }
}

// The triangles beside a border that moves slip with it, so their bounds must contain its movement.
TEST(SimplifyBorders, TheBoundsHoldBesideBordersThatMove) {
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const ChartedMesh mesh = ragged(seed, {.roughness = 0.02, .bumps = 0.02 * seed});
    SimplifyOptions options;
    options.max_border_slip_texels = 0.5;
    for (const double density : {4.0, 8.0, 16.0, 32.0}) {
      const SimplifiedMesh coarse = simplify(mesh, density, options);
      const ExactSlip exact = exact_slip(mesh, coarse, density);
      EXPECT_LE(exact.border, coarse.max_slip_texels + 1e-6) << seed << ' ' << density;
      EXPECT_LE(exact.inside, coarse.max_slip_texels + 1e-6) << seed << ' ' << density;
    }
  }
}

TEST(SimplifyBorders, ASeamKeepsTheBoundOfTheInside) {
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const ChartedMesh mesh = ragged(seed, {.bumps = seed % 2 * 0.05, .fold = true});
    std::size_t last = mesh.triangles() + 1;
    for (const double density : {60.0, 20.0, 6.0}) {
      const SimplifiedMesh coarse = simplify(mesh, density);
      const ExactSlip exact = exact_slip(mesh, coarse, density);
      EXPECT_LE(exact.border, coarse.max_slip_texels + 1e-6) << seed;
      EXPECT_LE(exact.inside, coarse.max_slip_texels + 1e-6) << seed;
      EXPECT_LE(open_edges(mesh.positions, coarse.indices).length,
                open_edges(mesh.positions, mesh.indices).length * 1.001);
      EXPECT_LT(coarse.triangles_out, last) << seed;
      last = coarse.triangles_out;
    }
  }
}

// A triangle with some more vertices on one side, alone or folded there against a second one.
TEST(SimplifyBorders, ASideOfFewVerticesBecomesOneEdge) {
  for (std::uint32_t more = 1; more <= 4; ++more) {
    ChartedMeshBuilder builder;
    for (const std::uint64_t charts : {1, 2}) {
      std::vector<Vertex> vertices = {{{0, 2, charts == 2 ? 1.0F : 0.0F}, {0, 2}}};
      std::vector<std::uint32_t> triangles;
      for (std::uint32_t i = 0; i < more + 2; ++i) {
        vertices.push_back({{float(i), 0, 0}, {double(i), 0}});
        if (i > 0) triangles.insert(triangles.end(), {0, i, i + 1});
      }
      builder.add_chart(vertices, triangles);
      EXPECT_EQ(simplify(builder.build(), 100).triangles_out, charts) << more;
    }
  }
}

// The fewest vertices are those of a regular polygon. What an edge of it cuts off counts twice, in
// space and in uv.
TEST(SimplifyBorders, OfADiscStayHardlyMoreVerticesThanItsBoundNeeds) {
  constexpr double kDensity = 100;
  for (const std::uint32_t n : {500u, 2000u, 5000u}) {
    std::vector<Vertex> vertices{{{0, 0, 0}, {0, 0}}};
    std::vector<std::uint32_t> triangles;
    for (std::uint32_t i = 0; i < n; ++i) {
      const double angle = 2 * M_PI * i / n;
      const Vec3f p{float(std::cos(angle)), float(std::sin(angle)), 0};
      vertices.push_back({p, {p.x, p.y}});
      triangles.insert(triangles.end(), {0, i + 1, (i + 1) % n + 1});
    }
    ChartedMeshBuilder builder;
    builder.add_chart(vertices, triangles);
    const SimplifyOptions options;
    const double sagitta = options.max_border_slip_texels / (2 * kDensity);
    const double fewest = M_PI / std::acos(1 - sagitta);
    const SimplifiedMesh coarse = simplify(builder.build(), kDensity, options);
    EXPECT_LT(double(coarse.triangles_out), 1.15 * fewest) << n;
  }
}

// Two folded plates touch where their folds cross. Each fold is straight, but another border passes
// through that point, so it stays in both.
TEST(SimplifyBorders, SeamsThatCrossAtAPointKeepIt) {
  constexpr int n = 8;
  ChartedMeshBuilder builder;
  for (const bool upper : {false, true}) {
    for (const int side : {0, 1}) {
      builder.add_grid(n, n, [=](double s, double t) {
        const float along = float(2 * s - 1), away = float(side ? -t : t);
        const float z = float(upper ? t : -t);
        // One side of each fold is mirrored in uv.
        return Vertex{upper ? Vec3f{away, along, z} : Vec3f{along, away, z},
                      {side ? 2 - 2 * s : 2 * s, std::sqrt(2.0) * t}};
      });
    }
  }
  const ChartedMesh mesh = builder.build();
  // The triangles of the mirrored charts get the other order of corners.
  ChartedMesh turned = mesh;
  for (std::size_t t = 0; t < mesh.triangles(); ++t) {
    if (mesh.charts.triangle_chart[t] % 2 == 0) continue;
    std::swap(turned.indices[3 * t + 1], turned.indices[3 * t + 2]);
    std::swap(turned.charts.triangle_uv[3 * t + 1], turned.charts.triangle_uv[3 * t + 2]);
  }
  const SimplifiedMesh coarse = simplify(turned, 50);
  expect_sound(turned, coarse, 50);
  std::vector<bool> has(4, false);
  for (std::size_t i = 0; i < coarse.indices.size(); ++i) {
    const Vec3f& p = turned.positions[coarse.indices[i]];
    if (p == Vec3f{0, 0, 0}) has[coarse.triangle_chart[i / 3]] = true;
  }
  EXPECT_EQ(has, std::vector<bool>(4, true));
  EXPECT_LE(coarse.triangles_out, 12U);
}

// A height field with a slit: the two sides of the slit have the same positions and uvs, but
// separate vertices, except at its tip.
ChartedMesh slit(int n, double amplitude) {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> triangles;
  const auto add = [&](int i, int j) {
    const double s = double(i) / n, t = double(j) / n;
    vertices.push_back({{float(s), float(t), float(amplitude * std::sin(5 * s + 4 * t))}, {s, t}});
    return static_cast<std::uint32_t>(vertices.size() - 1);
  };
  std::vector<std::uint32_t> above, below;  // the same except along the slit
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      below.push_back(add(i, j));
      above.push_back(2 * j == n && i < n / 2 ? add(i, j) : below.back());
    }
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const std::vector<std::uint32_t>& low = 2 * j == n ? above : below;
      const std::uint32_t a = low[j * (n + 1) + i], b = low[j * (n + 1) + i + 1],
                          c = below[(j + 1) * (n + 1) + i + 1], d = below[(j + 1) * (n + 1) + i];
      triangles.insert(triangles.end(), {a, b, c, a, c, d});
    }
  }
  ChartedMeshBuilder builder;
  builder.add_chart(vertices, triangles);
  return builder.build();
}

TEST(SimplifyBorders, ASlitStaysClosed) {
  for (const double amplitude : {0.0, 0.1}) {
    for (const int n : {4, 8, 16}) {
      const ChartedMesh mesh = slit(n, amplitude);
      const SimplifiedMesh coarse = simplify(mesh, 30);
      expect_sound(mesh, coarse, 30);
      EXPECT_LE(exact_slip(mesh, coarse, 30).inside, coarse.max_slip_texels + 1e-6);
      EXPECT_NEAR(uv_area(mesh, coarse), 1, 0.01);
      EXPECT_LE(coarse.triangles_out, amplitude == 0 ? 6U : mesh.triangles());
    }
  }
}

// A tube of few columns, cut open along its length. Both sides of the cut lie close to each other
// in one chart, so that what happens at one side matters at the other.
ChartedMesh tube(int columns, int rows, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<double> jitter;
  for (int i = 0; i < (columns + 1) * (rows + 1); ++i) {
    jitter.push_back(0.3 * (double(random() % 1000) / 1000 - 0.5));
  }
  ChartedMeshBuilder builder;
  builder.add_grid(columns, rows, [&](double s, double t) {
    const int i = static_cast<int>(std::lround(s * columns)) % columns,
              j = static_cast<int>(std::lround(t * rows));
    const double a = 2 * 3.14159265358979 * i / columns,
                 z = j + (j > 0 && j < rows ? jitter[j * columns + i] : 0);
    return Vertex{{float(std::cos(a)), float(std::sin(a)), float(z)},
                  {s * columns * 2 * std::sin(3.14159265358979 / columns), z}};
  });
  return builder.build();
}

TEST(SimplifyBorders, TheTwoSidesOfACutThroughANarrowTubeStayTogether) {
  for (const int columns : {2, 3, 4, 5}) {
    for (std::uint32_t seed = 1; seed <= 8; ++seed) {
      const ChartedMesh mesh = tube(columns, 12, seed);
      for (const double density : {0.3, 3.0, 30.0}) {
        const SimplifiedMesh coarse = simplify(mesh, density);
        expect_sound(mesh, coarse, density);
        EXPECT_LE(exact_slip(mesh, coarse, density).inside, coarse.max_slip_texels + 1e-6);
        // The sides of the tube are flat, so they become two triangles each. With two columns, both
        // sides of the cut have the same neighbours, so that the cut keeps its vertices.
        if (density > 1 && columns > 2) {
          EXPECT_EQ(coarse.triangles_out, 2U * static_cast<unsigned>(columns));
        }
      }
    }
  }
}

// A Moebius band cut along its middle is one ring of two turns, and both sides of the cut are the
// inner border of that ring. After one turn along the cut, each side goes on as the other.
ChartedMesh band_cut_along_its_middle(int n) {
  constexpr double kPi = 3.14159265358979;
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> triangles;
  const auto around = static_cast<std::uint32_t>(12 * n), rows = static_cast<std::uint32_t>(n);
  for (std::uint32_t j = 0; j <= rows; ++j) {
    for (std::uint32_t i = 0; i < around; ++i) {
      const double w = double(j) / rows;
      // The middle has the same positions in both turns.
      const double a = 4 * kPi * (j == 0 ? i % (around / 2) : i) / around;
      const double r = 4 + w * std::cos(a / 2), turn = 2 * kPi * i / around;
      vertices.push_back(
          {{float(r * std::cos(a)), float(r * std::sin(a)), float(w * std::sin(a / 2))},
           {(8 + w) * std::cos(turn), (8 + w) * std::sin(turn)}});
    }
  }
  for (std::uint32_t j = 0; j < rows; ++j) {
    for (std::uint32_t i = 0; i < around; ++i) {
      const std::uint32_t a = j * around + i, b = j * around + (i + 1) % around, c = b + around,
                          d = a + around;
      triangles.insert(triangles.end(), {a, c, b, a, d, c});
    }
  }
  ChartedMeshBuilder builder;
  builder.add_chart(vertices, triangles);
  return builder.build();
}

TEST(SimplifyBorders, ACutWhoseSidesAreExchangedStaysClosed) {
  const ChartedMesh mesh = band_cut_along_its_middle(6);
  for (const double density : {0.02, 0.1, 0.5, 2.0, 8.0}) {
    const SimplifiedMesh coarse = simplify(mesh, density);
    EXPECT_EQ(broken_triangles(mesh, coarse), 0U) << density;
    const OpenEdges before = open_edges(mesh.positions, mesh.indices),
                    after = open_edges(mesh.positions, coarse.indices);
    EXPECT_LE(after.count, before.count) << density;
    EXPECT_LE(after.length, before.length * 1.001) << density;
    EXPECT_LT(coarse.triangles_out, mesh.triangles() / 2) << density;
  }
}

}  // namespace
}  // namespace atlas
