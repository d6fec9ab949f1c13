#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "libatlas/param/solvers/multigrid.h"
#include "libatlas/param/solvers/stiffness.h"
#include "tests/param/shapes.h"

namespace atlas {
namespace {

using testing::Disc;
using Vector = std::vector<glm::dvec2>;
using Uvs = std::vector<Vec2d>;

Vector vector_of(const Uvs& uvs) {
  Vector out;
  for (const Vec2d& uv : uvs) out.emplace_back(uv.x, uv.y);
  return out;
}

// The system of a disc, with the matrix that the direct solvers use.
struct System {
  explicit System(const Disc& disc) {
    elements.build(disc.view(), 0);
    half_edges.build(disc.view());
    param::CornerLists corners;
    corners.build(elements, disc.positions.size());
    param::build_stiffness(elements, corners, matrix);
  }

  Vector product(const Vector& x) const {
    Vector out(x.size(), glm::dvec2(0));
    for (std::size_t i = 0; i < x.size(); ++i) {
      for (std::uint32_t k = matrix.first[i]; k < matrix.first[i + 1]; ++k) {
        out[i] += matrix.value[k] * (x[matrix.column[k]] - x[i]);
      }
    }
    return out;
  }
  double energy(const Vector& x) const {
    const Vector y = product(x);
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) sum += glm::dot(x[i], y[i]);
    return sum;
  }

  param::Elements elements;
  param::HalfEdges half_edges;
  param::SymmetricMatrix matrix;
};

Disc hills(std::uint32_t columns, std::uint32_t rows, double width) {
  return testing::make_grid(columns, rows, [=](double u, double v) {
    return Vec3d{width * u, v, 0.1 * std::sin(9 * u) * std::cos(7 * v)};
  });
}

// Returns a solution with long and short waves.
Vector waves(const Disc& disc) {
  Vector x;
  for (std::size_t i = 0; i < disc.positions.size(); ++i) {
    const Vec3d& p = disc.positions[i];
    x.emplace_back(p.x + 0.01 * std::sin(double(i)), p.y * p.x + std::cos(20 * p.y));
  }
  return x;
}

void expect_solved(const Disc& disc, double share) {
  const System system(disc);
  const Vector wanted = waves(disc);
  Vector load = system.product(wanted), left = wanted;
  Uvs x(wanted.size());
  const double before = system.energy(wanted);
  param::MultigridSolver solver;
  ASSERT_TRUE(solver.build(system.elements, system.half_edges, x.size()));
  ASSERT_TRUE(solver.solve({share * before, 0, 60}, load, x));
  for (std::size_t i = 0; i < x.size(); ++i) left[i] = wanted[i] - glm::dvec2(x[i].x, x[i].y);
  EXPECT_LT(system.energy(left), 10 * share * before);
}

TEST(Multigrid, ErrorsFallAsFarAsAskedFor) {
  for (const double share : {1e-3, 1e-7, 1e-12}) expect_solved(hills(120, 90, 1), share);
}

TEST(Multigrid, ErrorsFallBelowWhatOneCorrectionReaches) {
  // A correction in single precision ends far above this error, so the residual has to be computed
  // again.
  expect_solved(hills(60, 60, 1), 1e-14);
}

TEST(Multigrid, OneLevelWillDo) {
  expect_solved(hills(3, 2, 1), 1e-12);
  expect_solved(hills(12, 12, 1), 1e-12);
}

TEST(Multigrid, SliversAreSolvedForInDoublePrecision) {
  // Quads 20 000 times as wide as high: single precision would lose their heights.
  expect_solved(hills(4, 1200, 100000), 1e-18);
}

TEST(Multigrid, KnowsWhatIsLeftWhenStepsRunOut) {
  const Disc disc = hills(80, 80, 1);
  const System system(disc);
  const Vector wanted = waves(disc), load = system.product(wanted);
  Vector left = load;
  Uvs x(wanted.size());
  param::MultigridSolver solver;
  ASSERT_TRUE(solver.build(system.elements, system.half_edges, x.size()));
  ASSERT_FALSE(solver.solve({1e-12 * system.energy(wanted), 0, 3}, left, x));
  const Vector known = system.product(vector_of(x));
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_NEAR(left[i].x, load[i].x - known[i].x, 1e-6);
    EXPECT_NEAR(left[i].y, load[i].y - known[i].y, 1e-6);
  }
}

TEST(Multigrid, PowersOfTwoChangeNoBit) {
  const Disc disc = hills(100, 80, 1);
  Disc large = disc;
  testing::transform(large, 0x1p20);
  const System system(disc), other(large);
  const Vector wanted = waves(disc);
  Vector load = system.product(wanted), load_large = load;
  for (glm::dvec2& v : load_large) v *= 0x1p20;
  Uvs x(wanted.size()), x_large = x;
  param::MultigridSolver solver;
  ASSERT_TRUE(solver.build(system.elements, system.half_edges, x.size()));
  ASSERT_TRUE(solver.solve({1e-9, 0, 60}, load, x));
  ASSERT_TRUE(solver.build(other.elements, other.half_edges, x.size()));
  ASSERT_TRUE(solver.solve({1e-9 * 0x1p40, 0, 60}, load_large, x_large));
  for (std::size_t i = 0; i < x.size(); ++i)
    EXPECT_EQ((Vec2d{x[i].x * 0x1p20, x[i].y * 0x1p20}), x_large[i]);
}

}  // namespace
}  // namespace atlas
