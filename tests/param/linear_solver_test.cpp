#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "libatlas/param/solvers/linear_solver.h"
#include "libatlas/param/solvers/stiffness.h"
#include "tests/param/shapes.h"

namespace atlas {
namespace {

using testing::Disc;

// Returns the stiffness matrix by its textbook formula, half the cotangents of the angles opposite
// to each edge, as a dense matrix.
Eigen::MatrixXd cotangent_matrix(const Disc& disc, const std::vector<float>& weights) {
  const auto at = [&](std::uint32_t v) {
    const Vec3d& p = disc.positions[v];
    return Eigen::Vector3d(p.x, p.y, p.z);
  };
  const auto n = static_cast<Eigen::Index>(disc.positions.size());
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t t = 0; t < disc.triangles.size(); ++t) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t i = disc.triangles[t][(c + 1) % 3], j = disc.triangles[t][(c + 2) % 3];
      const Eigen::Vector3d a = at(i) - at(disc.triangles[t][c]),
                            b = at(j) - at(disc.triangles[t][c]);
      const double half_cotangent = 0.5 * double(weights[t]) * a.dot(b) / a.cross(b).norm();
      k(i, j) -= half_cotangent;
      k(j, i) -= half_cotangent;
      k(i, i) += half_cotangent;
      k(j, j) += half_cotangent;
    }
  }
  return k;
}

Disc rough_grid(std::uint32_t columns, std::uint32_t rows, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-0.3, 0.3);
  return testing::make_grid(columns, rows, [&](double u, double v) {
    return Vec3d{columns * u + shift(random), rows * v + shift(random), shift(random)};
  });
}

std::vector<float> random_weights(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> weight(0.01f, 5);
  std::vector<float> out(count);
  for (float& w : out) w = weight(random);
  return out;
}

// Solves for a known solution and expects it up to a constant per piece. The first vertices of the
// pieces are given.
template <class Solver>
void expect_solution(const Eigen::MatrixXd& k, Solver& solver,
                     const std::vector<std::uint32_t>& first_of_piece) {
  const Eigen::MatrixXd wanted = Eigen::MatrixXd::Random(k.rows(), 2);
  const Eigen::MatrixXd load = k * wanted;
  std::vector<glm::dvec2> b, x(static_cast<std::size_t>(k.rows()));
  for (Eigen::Index i = 0; i < k.rows(); ++i) b.emplace_back(load(i, 0), load(i, 1));
  solver.solve(b, x);
  for (std::size_t piece = 0; piece < first_of_piece.size(); ++piece) {
    const std::size_t begin = first_of_piece[piece];
    const std::size_t end =
        piece + 1 < first_of_piece.size() ? first_of_piece[piece + 1] : x.size();
    const auto row = [&](std::size_t i) {
      return glm::dvec2(wanted(Eigen::Index(i), 0), wanted(Eigen::Index(i), 1));
    };
    for (std::size_t i = begin; i < end; ++i) {
      EXPECT_LT(glm::distance(x[i] - x[begin], row(i) - row(begin)), 1e-9) << i;
    }
  }
}

TEST(EnvelopeSolver, SolvesTheCotangentSystemOfElements) {
  for (const auto& [columns, rows] :
       {std::pair{1u, 1u}, {2u, 1u}, {17u, 5u}, {3u, 40u}, {15u, 15u}}) {
    const Disc disc = rough_grid(columns, rows, columns + rows);
    param::Elements elements;
    elements.build(disc.view(), 0);
    param::EnvelopeSolver solver;
    solver.analyze(elements, disc.positions.size());
    solver.factorize(elements);
    const std::vector<float> even(disc.triangles.size(), 1);
    expect_solution(cotangent_matrix(disc, even), solver, {0});
  }
}

TEST(EnvelopeSolver, TakesNewWeightsOfTheSameElements) {
  const Disc disc = rough_grid(12, 9, 3);
  param::Elements elements;
  elements.build(disc.view(), 0);
  param::EnvelopeSolver solver;
  solver.analyze(elements, disc.positions.size());
  solver.factorize(elements);
  for (const unsigned seed : {1u, 2u}) {
    const std::vector<float> weights = random_weights(disc.triangles.size(), seed);
    for (std::size_t t = 0; t < weights.size(); ++t) elements.set_weight(t, weights[t]);
    solver.factorize(elements);
    expect_solution(cotangent_matrix(disc, weights), solver, {0});
  }
}

TEST(EnvelopeSolver, HoldsAVertexOfEachPiece) {
  Disc disc = rough_grid(7, 6, 5);
  const Disc other = rough_grid(4, 11, 6);
  const auto first = static_cast<std::uint32_t>(disc.positions.size());
  disc.positions.insert(disc.positions.end(), other.positions.begin(), other.positions.end());
  for (auto t : other.triangles) {
    for (std::uint32_t& v : t) v += first;
    disc.triangles.push_back(t);
  }
  param::Elements elements;
  elements.build(disc.view(), 0);
  const std::vector<float> even(disc.triangles.size(), 1);
  param::EnvelopeSolver of_elements, of_matrix;
  of_elements.analyze(elements, disc.positions.size());
  of_elements.factorize(elements);
  expect_solution(cotangent_matrix(disc, even), of_elements, {0, first});

  param::CornerLists corners;
  corners.build(elements, disc.positions.size());
  param::SymmetricMatrix matrix;
  param::build_stiffness(elements, corners, matrix);
  of_matrix.factorize(matrix);
  expect_solution(cotangent_matrix(disc, even), of_matrix, {0, first});
}

// Nothing of an earlier mesh may affect later results.
TEST(EnvelopeSolver, ForgetsEarlierMeshes) {
  const Disc disc = rough_grid(20, 20, 9);
  param::Elements elements;
  elements.build(disc.view(), 0);
  std::vector<std::vector<glm::dvec2>> solutions;
  for (int run = 0; run < 2; ++run) {
    param::EnvelopeSolver solver;
    if (run > 0) {  // it was used for another mesh before
      const Disc other = rough_grid(31, 8, 1);
      param::Elements others;
      others.build(other.view(), 0);
      solver.analyze(others, other.positions.size());
      solver.factorize(others);
    }
    solver.analyze(elements, disc.positions.size());
    solver.factorize(elements);
    std::vector<glm::dvec2> load(disc.positions.size()), x(load.size());
    for (std::size_t i = 0; i < load.size(); ++i)
      load[i] = {std::sin(double(i)), std::cos(double(i))};
    solver.solve(load, x);
    solutions.push_back(x);
  }
  EXPECT_EQ(solutions[0], solutions[1]);
}

param::SymmetricMatrix stiffness_of(const param::Elements& elements, std::size_t vertices) {
  param::CornerLists corners;
  corners.build(elements, vertices);
  param::SymmetricMatrix matrix;
  param::build_stiffness(elements, corners, matrix);
  return matrix;
}

TEST(SparseDirectSolver, SolvesTheCotangentSystemWithAnyWeights) {
  for (const auto& [columns, rows] : {std::pair{1u, 1u}, {17u, 5u}, {15u, 15u}}) {
    const Disc disc = rough_grid(columns, rows, columns);
    param::Elements elements;
    elements.build(disc.view(), 0);
    param::SparseDirectSolver solver;
    for (const unsigned seed : {1u, 2u}) {  // the second time with the ordering of the first
      const std::vector<float> weights = random_weights(disc.triangles.size(), seed);
      for (std::size_t t = 0; t < weights.size(); ++t) elements.set_weight(t, weights[t]);
      ASSERT_TRUE(solver.factorize(stiffness_of(elements, disc.positions.size()), seed > 1));
      expect_solution(cotangent_matrix(disc, weights), solver, {0});
    }
  }
}

// Around holes, there are more edges than vertices and triangles together.
TEST(SparseDirectSolver, SolvesTheCotangentSystemAroundHoles) {
  const std::uint32_t n = 21;
  Disc disc = rough_grid(n, n, 8);
  std::vector<std::array<std::uint32_t, 3>> kept;
  for (std::uint32_t t = 0; t < disc.triangles.size(); ++t) {
    const std::uint32_t column = t / 2 % n, row = t / 2 / n;
    if (column % 2 == 0 || row % 2 == 0) kept.push_back(disc.triangles[t]);
  }
  disc.triangles = kept;
  param::Elements elements;
  elements.build(disc.view(), 0);
  param::SparseDirectSolver solver;
  ASSERT_TRUE(solver.factorize(stiffness_of(elements, disc.positions.size()), false));
  const std::vector<float> even(disc.triangles.size(), 1);
  expect_solution(cotangent_matrix(disc, even), solver, {0});
}

// A chain of three vertices. The second link is so stiff that the sum with the first loses it.
param::SymmetricMatrix chain_without_hold() {
  const double stiff = 1e17;
  param::SymmetricMatrix matrix;
  matrix.diagonal = {1, stiff + 1, stiff};
  matrix.first = {0, 1, 3, 4};
  matrix.column = {1, 0, 2, 1};
  matrix.value = {-1, -1, -stiff, -stiff};
  return matrix;
}

template <class Solver>
void expect_finite(Solver& solver) {
  std::vector<glm::dvec2> x(3);
  solver.solve(std::vector<glm::dvec2>{{-1, 0}, {0.5, 0.25}, {0.5, -0.25}}, x);
  for (const glm::dvec2& v : x) EXPECT_TRUE(std::isfinite(v.x) && std::isfinite(v.y));
}

TEST(LinearSolvers, WhatRoundingMadeSingularHasAFiniteSolution) {
  const param::SymmetricMatrix matrix = chain_without_hold();
  ASSERT_EQ(matrix.diagonal[1], matrix.diagonal[2]);
  param::SparseDirectSolver direct;
  ASSERT_TRUE(direct.factorize(matrix, false));
  expect_finite(direct);
  param::EnvelopeSolver envelope;
  envelope.factorize(matrix);
  expect_finite(envelope);
}

// Stiff pairs of vertices, each of which hangs on the next by a link that rounding loses.
void expect_pairs_solved(double stiff) {
  const std::uint32_t pairs = 10;
  param::SymmetricMatrix matrix;
  matrix.first = {0};
  std::vector<glm::dvec2> load, x(2 * pairs);
  for (std::uint32_t v = 0; v < 2 * pairs; ++v) {
    matrix.diagonal.push_back(0);
    for (const std::uint32_t w : {v - 1, v + 1}) {
      if (w >= 2 * pairs) continue;  // beyond the ends of the chain
      matrix.column.push_back(w);
      matrix.value.push_back(std::max(v, w) % 2 == 1 ? -stiff : -1);
      matrix.diagonal.back() -= matrix.value.back();
    }
    matrix.first.push_back(static_cast<std::uint32_t>(matrix.column.size()));
    load.push_back(v % 2 == 0 ? glm::dvec2(stiff, 0) : glm::dvec2(-stiff, 0));
  }
  param::EnvelopeSolver solver;
  solver.factorize(matrix);
  solver.solve(load, x);
  for (std::uint32_t v = 0; v < 2 * pairs; v += 2) {
    EXPECT_NEAR(x[v].x - x[v + 1].x, 1, 1e-12) << stiff << " " << v;
    EXPECT_EQ(x[v].y, x[v + 1].y) << stiff << " " << v;
  }
}

TEST(EnvelopeSolver, LinksThatRoundingLosesLeaveTheirPairsSolved) {
  // What is left of a pivot is exactly zero where the stiffness has an exact root.
  for (const double stiff : {1e17, 3e17, std::ldexp(1.0, 58), std::ldexp(1.0, 61)})
    expect_pairs_solved(stiff);
}

TEST(SparseDirectSolver, SaysWhenAMatrixIsNotDefinite) {
  param::SymmetricMatrix matrix = chain_without_hold();
  matrix.diagonal[2] = -1;
  param::SparseDirectSolver solver;
  EXPECT_FALSE(solver.factorize(matrix, false));
}

}  // namespace
}  // namespace atlas
