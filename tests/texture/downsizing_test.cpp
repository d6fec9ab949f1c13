// The halving itself, on random textures with holes, compared with the definition.
#include "libatlas/texture/downsizing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "libatlas/texture/chart_textures.h"

namespace atlas {
namespace {

SampledChart random_texture(std::mt19937& random, double amplitude) {
  SampledChart c;
  c.width = 16 + static_cast<int>(random() % 100);
  c.height = 16 + static_cast<int>(random() % 100);
  c.texels.resize(std::size_t(c.width) * c.height);
  for (std::size_t i = 0; i < c.texels.size(); ++i) {
    const double x = static_cast<double>(i % c.width) / c.width;
    c.texels[i].weight = random() % 4 ? 1.0f : 0.0f;
    for (float& v : c.texels[i].rgb)
      v = static_cast<float>(0.3 + 0.1 * x + amplitude * (random() % 1000) / 1000.0);
  }
  return c;
}

// Halves the texture into `out`. Returns the largest |mean - texel| over its quads.
double definition(const SampledChart& in, SampledChart& out) {
  double worst = 0;
  out = {(in.width + 1) / 2, (in.height + 1) / 2, {}};
  out.texels.resize(std::size_t(out.width) * out.height);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      for (int k = 0; k < 3; ++k) {
        std::vector<double> v;
        for (int q = 0; q < 4; ++q) {
          const int i = 2 * x + q % 2, j = 2 * y + q / 2;
          if (i >= in.width || j >= in.height) continue;
          const auto& t = in.texels[std::size_t(j) * in.width + i];
          if (t.weight > 0) v.push_back(t.rgb[k]);
        }
        if (v.empty()) continue;
        double mean = 0;
        for (const double a : v) mean += a / static_cast<double>(v.size());
        for (const double a : v) worst = std::max(worst, std::fabs(a - mean));
        auto& t = out.texels[std::size_t(y) * out.width + x];
        t.rgb[k] = static_cast<float>(mean);
        t.weight = 1;
      }
  return worst;
}

// Errors of the interpolated texture over covered texels.
struct Errors {
  double worst = 0, square_sum = 0;
  std::int64_t covered = 0;
};

// Only covered texels of the small texture are interpolated.
Errors interpolation_errors(const SampledChart& full, const SampledChart& small, int halvings) {
  Errors errors;
  for (int y = 0; y < full.height; ++y)
    for (int x = 0; x < full.width; ++x) {
      const auto& wanted = full.texels[std::size_t(y) * full.width + x];
      if (!(wanted.weight > 0)) continue;
      ++errors.covered;
      const double u = std::ldexp(x + 0.5, -halvings) - 0.5;
      const double v = std::ldexp(y + 0.5, -halvings) - 0.5;
      double sum[3] = {0, 0, 0}, weights = 0;
      for (int j = 0; j < small.height; ++j) {
        const double beyond_j = j == 0                  ? std::min(v, 0.0)
                                : j + 1 == small.height ? std::max(v - j, 0.0)
                                                        : 0;
        const double share_j = std::max(0.0, 1 - std::fabs(v - beyond_j - j));
        if (share_j == 0) continue;
        for (int i = 0; i < small.width; ++i) {
          const double beyond_i = i == 0                 ? std::min(u, 0.0)
                                  : i + 1 == small.width ? std::max(u - i, 0.0)
                                                         : 0;
          const double share = share_j * std::max(0.0, 1 - std::fabs(u - beyond_i - i));
          const auto& t = small.texels[std::size_t(j) * small.width + i];
          if (share == 0 || !(t.weight > 0)) continue;
          weights += share;
          for (int k = 0; k < 3; ++k) sum[k] += share * t.rgb[k];
        }
      }
      if (weights == 0) continue;
      for (int k = 0; k < 3; ++k) {
        const double error = std::fabs(sum[k] / weights - wanted.rgb[k]);
        errors.worst = std::max(errors.worst, error);
        errors.square_sum += error * error;
      }
    }
  return errors;
}

TEST(Downsizing, FollowsTheDefinition) {
  std::mt19937 random(8);
  int counts[4] = {0, 0, 0, 0}, taken_back = 0;
  HalvedCharts room;
  for (int trial = 0; trial < 400; ++trial) {
    const double amplitude = std::pow(10.0, -1 - (random() % 300) / 100.0);
    const SampledChart full = random_texture(random, amplitude);
    TextureOptions o;
    o.min_side = 1 + static_cast<int>(random() % 20);
    std::vector<SampledChart> levels{full};
    bool close = false;
    for (;;) {
      const SampledChart& last = levels.back();
      if ((std::min(last.width, last.height) + 1) / 2 < o.min_side) break;
      if (last.width == 1 && last.height == 1) break;
      SampledChart next;
      const double worst = definition(last, next);
      close = close || std::fabs(worst - o.threshold) < 1e-6;
      if (!(worst < o.threshold)) break;
      levels.push_back(next);
    }
    while (levels.size() > 1) {
      const double error = interpolation_errors(full, levels.back(), int(levels.size()) - 1).worst;
      close = close || std::fabs(error - 2 * o.threshold) < 1e-6;
      if (error <= 2 * o.threshold) break;
      levels.pop_back();
      ++taken_back;
    }
    if (close) continue;  // rounding decides
    const int want = int(levels.size()) - 1;
    const SampledChart& current = levels.back();
    // `room` is used again and again, as in the library.
    const Downsizing d = downsize(full, o, room);
    ASSERT_EQ(d.halvings, want);
    ASSERT_EQ(d.width, current.width);
    ASSERT_EQ(d.height, current.height);
    const Errors errors = interpolation_errors(full, current, want);
    ASSERT_EQ(d.covered, errors.covered);
    ASSERT_NEAR(d.max_error, want > 0 ? errors.worst : 0, 1e-6);
    ASSERT_NEAR(d.square_sum, want > 0 ? errors.square_sum : 0, 1e-4 * errors.square_sum + 1e-9);
    ++counts[std::min(want, 3)];
  }
  for (const int c : counts) EXPECT_GT(c, 5);
  EXPECT_GT(taken_back, 0);
}

// Tiles of 16 texels, whose edges lie between quads at four levels, must not be smeared.
TEST(Downsizing, KeepsEdgesBetweenQuads) {
  SampledChart c{256, 256, std::vector<SampledChart::Texel>(256 * 256)};
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 256; ++x) {
      auto& t = c.texels[std::size_t(y) * 256 + x];
      t.weight = 1;
      for (float& v : t.rgb) v = (x / 16 + y / 16) % 2 ? 0.8f : 0.2f;
    }
  HalvedCharts room;
  const Downsizing d = downsize(c, {}, room);
  EXPECT_EQ(d.halvings, 0);
  EXPECT_EQ(d.width, 256);
  EXPECT_EQ(d.max_error, 0);
  // All texels are measured, also where a threshold turns downsizing off.
  EXPECT_EQ(d.covered, 256 * 256);
  TextureOptions off;
  off.threshold = -1;
  EXPECT_EQ(downsize(c, off, room).covered, 256 * 256);
  // Steps that interpolation may smear do not matter.
  for (auto& t : c.texels)
    for (float& v : t.rgb) v = 0.5f + 0.01f * (v - 0.5f);
  const Downsizing faint = downsize(c, {}, room);
  EXPECT_EQ(faint.halvings, 4);
  EXPECT_NEAR(faint.max_error, 0.0045, 0.0016);
}

TEST(Downsizing, ReportsTheErrorOfTheUpSampledTexture) {
  // All texels have one value, except that one texel differs from it by a known amount. Up-sampled
  // values then lie between those of the coarse texels, and the errors can be computed by hand.
  SampledChart c{64, 64, std::vector<SampledChart::Texel>(64 * 64)};
  for (auto& t : c.texels) {
    t.weight = 1;
    for (float& v : t.rgb) v = 0.5f;
  }
  c.texels[20 * 64 + 20].rgb[1] = 0.506f;
  TextureOptions o;
  o.min_side = 32;
  HalvedCharts room;
  const Downsizing d = downsize(c, o, room);
  ASSERT_EQ(d.halvings, 1);
  EXPECT_EQ(d.covered, 64 * 64);
  // The quad's mean is 0.5015. The look-up at the texel is a quarter texel off the coarse centre in
  // x and y, so it finds (3/4)² of the difference. The neighbours get the rest of the tent filter.
  const double rise = 0.0015, weights[4] = {0.25, 0.75, 0.75, 0.25};
  double sum = 0, worst = 0;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      const double got = rise * weights[i] * weights[j], want = i == 1 && j == 1 ? 0.006 : 0.0;
      sum += (got - want) * (got - want);
      worst = std::max(worst, std::fabs(got - want));
    }
  EXPECT_NEAR(d.max_error, worst, 1e-6);
  EXPECT_NEAR(d.square_sum, sum, 1e-8);
}

TEST(Downsizing, StopsWithoutACrashOnASingleTexel) {
  SampledChart c{1, 1, std::vector<SampledChart::Texel>(1)};
  TextureOptions o;
  o.min_side = 1;
  HalvedCharts room;
  EXPECT_EQ(downsize(c, o, room).halvings, 0);
}

}  // namespace
}  // namespace atlas
