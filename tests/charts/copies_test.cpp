#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "tests/charts/chart_checks.h"

namespace atlas::test {
namespace {

// Returns the part with a random rotation and position, computed in double and rounded once.
Shape placed(Shape part, std::mt19937& random) {
  std::normal_distribution<double> gauss;
  double q[4], norm = 0;
  for (double& c : q) {
    c = gauss(random);
    norm += c * c;
  }
  for (double& c : q) c /= std::sqrt(norm);
  const auto [x, y, z, w] = q;
  const double r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                          {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                          {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
  const double shift[3] = {20 * gauss(random), 20 * gauss(random), 20 * gauss(random)};
  for (Vec3f& p : part.positions) {
    double out[3];
    for (int i = 0; i < 3; ++i) {
      out[i] = r[i][0] * p.x + r[i][1] * p.y + r[i][2] * p.z + shift[i];
    }
    p = {float(out[0]), float(out[1]), float(out[2])};
  }
  return part;
}

const std::vector<Shape>& kinds() {
  static const std::vector<Shape> all{box(4, {1, 2, 3}), torus(40, 16), plate_with_holes(2, 2),
                                      noisy(icosphere(3), 0.03, 5)};
  return all;
}

struct Assembly {
  Mesh mesh;
  std::vector<std::size_t> kind, first_triangle;  // one entry per part
};

Assembly assembly(int parts) {
  std::mt19937 random(3);
  Assembly out;
  Shape all;
  for (int i = 0; i < parts; ++i) {
    out.kind.push_back(random() % kinds().size());
    out.first_triangle.push_back(all.triangle_count());
    all = together(all, placed(kinds()[out.kind.back()], random));
  }
  out.mesh = Mesh(all);
  return out;
}

ChartSet charts_of(const MeshView& mesh, const ChartOptions& options = {}, int threads = 1) {
  Context context;
  context.threads = threads;
  Result<ChartSet> set = make_charts(mesh, options, context);
  EXPECT_TRUE(set.ok());
  return set.ok() ? std::move(*set) : ChartSet{};
}

// Returns the lengths that edges of these triangles have when they are flat, ascending.
std::vector<double> flat_edges(const ChartSet& set, std::size_t first, std::size_t count) {
  std::vector<double> lengths;
  for (std::size_t t = first; t < first + count; ++t) {
    for (int c = 0; c < 3; ++c) {
      const Vec2d a = set.uvs[set.triangle_uv[3 * t + c]];
      const Vec2d b = set.uvs[set.triangle_uv[3 * t + (c + 1) % 3]];
      lengths.push_back(std::hypot(a.x - b.x, a.y - b.y));
    }
  }
  std::sort(lengths.begin(), lengths.end());
  return lengths;
}

// A part that is symmetric may take them turned.
TEST(Copies, TakeTheChartsOfTheirOriginals) {
  const Assembly parts = assembly(40);
  const ChartSet set = charts_of(parts.mesh.view());
  const ChartFindings found = check_charts(parts.mesh.view(), set);
  EXPECT_EQ(found.fault, "");
  EXPECT_LE(found.stretch_999, 1.25 + 1e-6);
  EXPECT_EQ(set.copied_pieces, 40 - kinds().size());
  std::map<std::size_t, std::size_t> original;  // the first part of each kind
  for (std::size_t i = 0; i < parts.kind.size(); ++i) {
    const std::size_t a = parts.first_triangle[original.emplace(parts.kind[i], i).first->second];
    const std::size_t b = parts.first_triangle[i];
    const std::size_t triangles = kinds()[parts.kind[i]].triangle_count();
    ASSERT_EQ(flat_edges(set, a, triangles), flat_edges(set, b, triangles)) << "part " << i;
  }
}

TEST(Copies, DoNotDependOnThreadsOrUnits) {
  const Assembly parts = assembly(30);
  const ChartSet one = charts_of(parts.mesh.view());
  for (const int threads : {2, 8}) {
    EXPECT_EQ(bytes(charts_of(parts.mesh.view(), {}, threads)), bytes(one));
  }
  for (const double unit : {0x1p-30, 1e-3, 39.37}) {
    Mesh scaled = parts.mesh;
    for (Vec3f& p : scaled.positions) {
      p = {float(p.x * unit), float(p.y * unit), float(p.z * unit)};
    }
    const ChartSet set = charts_of(scaled.view());
    EXPECT_EQ(set.copied_pieces, one.copied_pieces) << unit;
    EXPECT_EQ(set.charts.size(), one.charts.size()) << unit;
  }
}

TEST(Copies, KeepTheLimitOnCones) {
  const Assembly parts = assembly(30);
  ChartOptions options;
  options.cone_degrees = 35;
  const ChartSet set = charts_of(parts.mesh.view(), options);
  const ChartFindings found = check_charts(parts.mesh.view(), set);
  EXPECT_EQ(found.fault, "");
  EXPECT_LE(found.cone_degrees, 35 + 1e-4);
  EXPECT_GT(set.copied_pieces, 0u);
}

// Returns the number of copies found when the other part lies beside the first one.
std::size_t copied_beside(const Shape& part, Shape other, const std::vector<float>& density = {}) {
  other = moved(std::move(other), 1, {10, 3, 2});
  const Mesh mesh(together(part, other));
  MeshView view = mesh.view();
  view.density = density;
  return charts_of(view).copied_pieces;
}

TEST(Copies, AreNothingButCongruent) {
  const Shape part = noisy(icosphere(2), 0.05, 9);
  EXPECT_EQ(copied_beside(part, part), 1u);
  const auto stretched = [&](double x) {
    Shape s = part;
    for (Vec3f& p : s.positions) p.x = float(p.x * x);
    return s;
  };
  EXPECT_EQ(copied_beside(part, stretched(1 + 2e-6)), 1u);
  EXPECT_EQ(copied_beside(part, stretched(1.001)), 0u);
  EXPECT_EQ(copied_beside(part, stretched(-1)), 0u);  // mirrored and inside out
  Shape mirrored = stretched(-1);
  for (std::size_t i = 0; i < mirrored.indices.size(); i += 3) {
    std::swap(mirrored.indices[i + 1], mirrored.indices[i + 2]);
  }
  EXPECT_EQ(copied_beside(part, mirrored), 0u);
  Shape reordered = part;
  std::rotate(reordered.indices.begin(), reordered.indices.begin() + 3, reordered.indices.end());
  EXPECT_EQ(copied_beside(part, reordered), 1u);
  std::vector<float> density(2 * part.triangle_count(), 1.0f);
  EXPECT_EQ(copied_beside(part, part, density), 1u);
  density.back() = 2;
  EXPECT_EQ(copied_beside(part, part, density), 0u);
}

// Walls that are bent by a right angle each, and a needle beside the last wall, so thin that its
// lean is within the tolerance of congruence. Parts lie side by side; every second one is wider.
Mesh leaning(const std::vector<double>& lean_degrees, bool interleaved) {
  constexpr double kThin = 1e-5;
  Shape all;
  std::vector<Shape> parts;
  for (std::size_t i = 0; i < lean_degrees.size(); ++i) {
    const double lean = lean_degrees[i] * M_PI / 180;
    Shape part;
    part.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0},
                      {0, 1, 1}, {1, 1, 1}, {0, 2, 1}, {1, 2, 1}};
    for (const std::uint32_t k : {4u, 2u, 0u}) part.add_quad(k, k + 1, k + 3, k + 2);
    part.positions.push_back(
        {0.5f, float(-kThin * std::cos(lean)), float(-kThin * std::sin(lean))});
    part.indices.insert(part.indices.end(), {0, 8, 1});
    if (i % 2) {
      for (Vec3f& p : part.positions) p.x *= 2;
    }
    parts.push_back(moved(part, 1, {4.0 * double(i), 0, 0}));
    all = together(all, parts.back());
  }
  if (interleaved) {
    const std::vector<std::uint32_t> order = all.indices;
    const std::size_t triangles = parts[0].triangle_count();
    for (std::size_t t = 0; t < all.triangle_count(); ++t) {
      const std::size_t from = t % parts.size() * triangles + t / parts.size();
      std::copy_n(&order[3 * from], 3, &all.indices[3 * t]);
    }
  }
  return Mesh(all);
}

// What is congruent but for something tiny need not have the same cone. Such a copy is cut anew.
TEST(Copies, BeyondTheConeGetChartsOfTheirOwn) {
  ChartOptions options;
  options.cone_degrees = 30;
  for (const bool interleaved : {false, true}) {
    for (const std::vector<double>& leans : {std::vector<double>{0, 0, 100, 0, 100, 0},
                                             {0, 0, 100, 100},
                                             {0, 0, 0, 100, 0},
                                             {0, 0, 0, 0}}) {
      const Mesh mesh = leaning(leans, interleaved);
      const ChartSet set = charts_of(mesh.view(), options);
      const ChartFindings found = check_charts(mesh.view(), set);
      EXPECT_EQ(found.fault, "");
      EXPECT_LE(found.cone_degrees, 30 + 1e-4);
      const auto alike = std::count(leans.begin(), leans.end(), 0.0);
      EXPECT_EQ(set.copied_pieces, std::size_t(alike - 2));
      // A needle that leans is a chart by itself.
      EXPECT_EQ(set.charts.size(), 3 * leans.size() + leans.size() - std::size_t(alike));
      EXPECT_EQ(bytes(charts_of(mesh.view(), options, 4)), bytes(set));
    }
  }
}

// Strips so narrow that one twice as wide is congruent. Stretched to the other's width it would
// exceed the bound.
TEST(Copies, KeepToTheBound) {
  Shape strip;
  strip.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1e-5f, 0}, {0, 1e-5f, 0}};
  strip.add_quad(0, 1, 2, 3);
  Shape wide = strip;
  for (Vec3f& p : wide.positions) p.y *= 2;
  const Mesh mesh(together(strip, moved(wide, 1, {2, 0, 0})));
  const ChartSet set = charts_of(mesh.view());
  const ChartFindings found = check_charts(mesh.view(), set);
  EXPECT_EQ(found.fault, "");
  EXPECT_LE(found.stretch_999, ChartOptions{}.max_stretch);
}

// Plates whose density doubles along them are flat only with that density.
TEST(Copies, HaveTheStretchOfTheirOriginals) {
  const Shape plate = grid(40, 8, 5, 1);
  const Mesh mesh(together(plate, moved(plate, 1, {0, 4, 0})));
  std::vector<float> density;
  for (std::size_t t = 0; t < mesh.indices.size() / 3; ++t)
    density.push_back(std::exp2(mesh.positions[mesh.indices[3 * t]].x / 5));
  MeshView view = mesh.view();
  view.density = density;
  const ChartSet set = charts_of(view);
  ASSERT_EQ(set.charts.size(), 2u);
  EXPECT_EQ(set.copied_pieces, 1u);
  const Distortion &a = set.charts[0].distortion, &b = set.charts[1].distortion;
  EXPECT_LT(a.stretch_999, 1.1);
  EXPECT_NEAR(b.stretch_999, a.stretch_999, 1e-5);
  EXPECT_NEAR(b.stretch_l2, a.stretch_l2, 1e-5);
  EXPECT_NEAR(b.surface_area, a.surface_area, 1e-5 * a.surface_area);
}

// Copies of two kinds, each with a density of its own: charts have the area of their surface times
// the density squared.
TEST(Copies, HaveTheDensityOfTheirKind) {
  const Shape square = grid(3, 3), strip = grid(9, 2, 3, 0.5);
  Shape all;
  std::vector<float> density;
  for (int i = 0; i < 6; ++i) {
    const Shape& part = i % 2 ? strip : square;
    all = together(all, moved(part, 1, {0, 2.0 * i, 0}));
    density.insert(density.end(), part.triangle_count(), i % 2 ? 5.0f : 2.0f);
  }
  const Mesh mesh(all);
  MeshView view = mesh.view();
  view.density = density;
  const ChartSet set = charts_of(view);
  ASSERT_EQ(set.charts.size(), 6u);
  EXPECT_EQ(set.copied_pieces, 4u);
  for (const Chart& chart : set.charts) {
    const std::uint32_t t = set.chart_triangles[chart.first_triangle];
    EXPECT_NEAR(chart.size.x * chart.size.y, density[t] == 5.0f ? 25 * 1.5 : 4, 1e-4);
  }
}

// Charts of another piece are divided, and counted, as beside a plate that is no copy.
TEST(Copies, DoNotHideThatOtherChartsAreDivided) {
  ChartOptions options;
  options.max_stretch = 1.02;
  std::uint64_t divided = 0;
  for (const Shape& shape : {icosphere(3), torus(30, 16), noisy(icosphere(2), 0.1, 3)}) {
    std::uint64_t split[2];
    for (const bool copied : {false, true}) {
      const Shape plate = moved(grid(20, 20), 1, {9, 0, 0});
      const Shape other = moved(grid(20, 20, copied ? 1 : 1.5), 1, {9, 5, 0});
      const Mesh mesh(together(together(shape, plate), other));
      const ChartSet set = charts_of(mesh.view(), options);
      EXPECT_EQ(set.copied_pieces, copied ? 1u : 0u) << shape.name;
      split[copied] = set.repairs.split_charts;
    }
    EXPECT_EQ(split[0], split[1]) << shape.name;
    divided += split[0];
  }
  EXPECT_GT(divided, 0u);
}

// A flap that is bent up and one that is bent down have the same edge lengths in order.
TEST(Copies, FoldToTheSameSide) {
  Shape up;
  up.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1.25f, 1, 0.5f}};
  up.indices = {0, 1, 2, 1, 3, 2};
  Shape down = up;
  down.positions[3].z = -0.5f;
  EXPECT_EQ(copied_beside(up, up), 1u);
  EXPECT_EQ(copied_beside(up, down), 0u);
}

}  // namespace
}  // namespace atlas::test
