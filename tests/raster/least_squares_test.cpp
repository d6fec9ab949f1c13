// Compares the iterative solution with dense normal equations that are solved directly.
#include "libatlas/raster/least_squares.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

namespace atlas {
namespace {

struct Problem {
  int width, height;
  struct Sample {
    double x, y, weight;  // between texel centres: 0 to width-1, 0 to height-1
    Lanes rgb;
  };
  std::vector<Sample> samples;
};

TexelGrid solve(const Problem& p, float low, float high) {
  LeastSquares fit(p.width, p.height);
  for (const auto& s : p.samples) {
    const int i = std::min(static_cast<int>(s.x), p.width - 2);
    const int j = std::min(static_cast<int>(s.y), p.height - 2);
    fit.add(i, j,
            LeastSquares::Splat(static_cast<float>(s.x - i), static_cast<float>(s.y - j),
                                static_cast<float>(s.weight)),
            s.rgb);
  }
  return std::move(fit).solve(low, high);
}

// Returns the minimum-norm least-squares solution by QR over all samples, without smoothing.
Eigen::MatrixXd solve_directly(const Problem& p) {
  const int n = p.width * p.height, m = static_cast<int>(p.samples.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(m, n), b(m, 3);
  for (int r = 0; r < m; ++r) {
    const auto& s = p.samples[r];
    const double w = std::sqrt(s.weight);
    const int i = std::min(static_cast<int>(s.x), p.width - 2);
    const int j = std::min(static_cast<int>(s.y), p.height - 2);
    const double tx = s.x - i, ty = s.y - j;
    a(r, j * p.width + i) = w * (1 - tx) * (1 - ty);
    a(r, j * p.width + i + 1) = w * tx * (1 - ty);
    a(r, (j + 1) * p.width + i) = w * (1 - tx) * ty;
    a(r, (j + 1) * p.width + i + 1) = w * tx * ty;
    for (int k = 0; k < 3; ++k) b(r, k) = w * s.rgb[k];
  }
  return a.completeOrthogonalDecomposition().solve(b);
}

TEST(LeastSquares, MeetsTheDirectSolution) {
  std::mt19937 random(4);
  const auto uniform = [&](double most) { return most * (random() % 10000) / 9999.0; };
  for (int trial = 0; trial < 6; ++trial) {
    Problem p{12, 9, {}};
    for (int i = 0; i < 3000; ++i) {
      const double x = uniform(p.width - 1), y = uniform(p.height - 1);
      const float v = static_cast<float>(0.5 + 0.3 * std::sin(x * 0.9) * std::cos(y * 0.7 + trial));
      p.samples.push_back({x, y, 0.02 + uniform(0.05), Lanes{v, 1 - v, v * v, 1}});
    }
    const Eigen::MatrixXd want = solve_directly(p);
    const TexelGrid got = solve(p, -10, 10);
    for (int i = 0; i < p.width * p.height; ++i) {
      ASSERT_TRUE(got.known[i]);
      for (int k = 0; k < 3; ++k) ASSERT_NEAR(got.rgb[i][k], want(i, k), 0.03) << i;
    }
    // The remaining error of the sweeps shows in the energy, which is within a few per cent of the
    // best. The test allows 25 %.
    const auto energy = [&](auto value) {
      double e = 0;
      for (const auto& s : p.samples) {
        const int i = std::min(static_cast<int>(s.x), p.width - 2);
        const int j = std::min(static_cast<int>(s.y), p.height - 2);
        const double tx = s.x - i, ty = s.y - j;
        const double v = (1 - ty) * ((1 - tx) * value(i, j) + tx * value(i + 1, j)) +
                         ty * ((1 - tx) * value(i, j + 1) + tx * value(i + 1, j + 1));
        e += s.weight * (v - s.rgb[0]) * (v - s.rgb[0]);
      }
      return e;
    };
    const double best = energy([&](int i, int j) { return want(j * p.width + i, 0); });
    const double reached =
        energy([&](int i, int j) { return double{got.rgb[std::size_t(j) * p.width + i][0]}; });
    EXPECT_LE(reached, 1.25 * best);
  }
}

// Holds for all weights and positions of samples: charts far below a texel, slivers, and borders
// that barely reach a texel. Slivers once lost a twentieth of the value to the weight of the
// differences.
TEST(LeastSquares, ConstantsStayConstants) {
  std::mt19937 random(6);
  const auto uniform = [&](double most) { return most * (random() % 1000000) / 999999.0; };
  struct Cloud {
    double width, height, weight;
  };
  for (const Cloud cloud : {Cloud{4, 4, 0.02}, Cloud{0.3, 0.3, 0.02}, Cloud{1e-3, 1e-3, 1e-5},
                            Cloud{4, 1e-3, 1e-6}, Cloud{4, 4, 1e-3}}) {
    for (int trial = 0; trial < 100; ++trial) {
      const float value = static_cast<float>(0.05 + uniform(0.9));
      const double left = 0.5 + uniform(2.4), low = 0.5 + uniform(2.4);
      Problem p{8, 8, {}};
      for (int i = 0; i < 200; ++i)
        p.samples.push_back({left + uniform(cloud.width), low + uniform(cloud.height), cloud.weight,
                             Lanes{value, 0, 1, 1}});
      const TexelGrid got = solve(p, 0, 1);
      for (std::size_t i = 0; i < got.rgb.size(); ++i) {
        if (!got.known[i]) continue;
        ASSERT_NEAR(got.rgb[i][0], value, 1e-4) << cloud.width << " x " << cloud.height;
        ASSERT_NEAR(got.rgb[i][2], 1, 1e-4);
      }
    }
  }
}

TEST(LeastSquares, RowsEqualSingleSamples) {
  std::mt19937 random(5);
  LeastSquares single(20, 6), runs(20, 6);
  for (int trial = 0; trial < 200; ++trial) {
    const int x = static_cast<int>(random() % 10), y = static_cast<int>(random() % 5);
    const int n = 1 + static_cast<int>(random() % 9);
    const LeastSquares::Splat splat{(random() % 100) / 100.0f, (random() % 100) / 100.0f, 0.25f};
    std::vector<Lanes> colours;
    for (int i = 0; i < n; ++i) {
      colours.push_back(Lanes{(random() % 100) / 100.0f, 0.5f, 0.25f, 1});
      single.add(x + i, y, splat, colours.back());
    }
    runs.add_row({x, y, splat}, colours.data(), n);
  }
  const TexelGrid a = std::move(single).solve(0, 1), b = std::move(runs).solve(0, 1);
  EXPECT_EQ(a.known, b.known);
  for (std::size_t i = 0; i < a.rgb.size(); ++i) ASSERT_NEAR(a.rgb[i][0], b.rgb[i][0], 1e-4);
}

TEST(LeastSquares, KeepsToItsBoundsAndLeavesUntouchedTexelsUnknown) {
  LeastSquares fit(40, 4);
  // A step from 0 to 1. Without bounds, the texels would overshoot on both sides.
  for (int i = 4; i < 30; ++i)
    for (int s = 0; s < 8; ++s) {
      const float tx = (static_cast<float>(s) + 0.5f) / 8;
      const float v = static_cast<float>(i) + tx < 16.4f ? 0.0f : 1.0f;
      fit.add(i, 1, LeastSquares::Splat(tx, 0.5f, 0.1f), Lanes{v, v, v, 1});
    }
  const TexelGrid x = std::move(fit).solve(0, 1);
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 40; ++i) {
      const std::size_t at = std::size_t(j) * 40 + i;
      EXPECT_EQ(x.known[at], (j == 1 || j == 2) && i >= 4 && i <= 30);
      EXPECT_TRUE(!x.known[at] || (x.rgb[at][0] >= 0 && x.rgb[at][0] <= 1));
    }
  EXPECT_LT(x.rgb[40 + 12][0], 0.02f);
  EXPECT_GT(x.rgb[40 + 22][0], 0.98f);
}

}  // namespace
}  // namespace atlas
