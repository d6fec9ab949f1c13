#include "libatlas/texture/chart_textures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>

#include "libatlas/texture/downsizing.h"
#include "tests/texture/lit_shapes.h"

namespace atlas {
namespace {

// Display values are the sRGB encoding of luminance; white is 1.
const ToneMapping kPlain{};

TextureResult size_textures(const LitShape& shape, const TextureOptions& options, int threads = 1) {
  const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
  Context context;
  context.threads = threads;
  auto r = size_chart_textures({sampler, shape.charts, kPlain}, options, context);
  EXPECT_TRUE(r.ok()) << r.status().message();
  return *r;
}

// Returns the illumination whose display value is d.
Vec3f shown(double d) {
  const float v = srgb_decode(static_cast<float>(d));
  return {v, v, v};
}

TextureOptions options(double texel, double threshold = 2.0 / 255) {
  TextureOptions o;
  o.texel = texel;
  o.threshold = threshold;
  return o;
}

TEST(ChartTextures, HaveTheTexelLengthAskedFor) {
  const LitShape shape =
      make_sheet({2.5, 1.2, 4, 4}, [](double u, double) { return shown(u / 3); });
  const ChartTexture t = size_textures(shape, options(0.01, 0)).charts[0];
  EXPECT_EQ(t.full_width, 250);
  EXPECT_EQ(t.full_height, 120);
  EXPECT_EQ(t.width, 250);
  EXPECT_EQ(t.texels_per_unit, (Vec2d{100, 100}));
  EXPECT_EQ(t.content, ChartContent::varied);
}

TEST(ChartTextures, ShrinkChartsOfOneColourToTheSmallestSide) {
  LitShape shape = make_sheet({4, 1, 9, 9}, [](double, double) { return Vec3f{1, 2, 3}; });
  append(shape, make_sheet({4, 0.1, 9, 9}, [](double, double) { return Vec3f{}; }), {0, 0, 1});
  // The sheet is lit but its material is black, so its texture counts as unlit.
  append(shape, make_sheet({4, 4, 3, 3, 0, {0, 0, 0}}, [](double u, double) { return shown(u); }),
         {0, 0, 2});
  const TextureResult r = size_textures(shape, options(0.01));
  EXPECT_EQ(r.charts[0].content, ChartContent::uniform);
  EXPECT_EQ(r.charts[0].width, 16);
  EXPECT_EQ(r.charts[0].height, 16);
  EXPECT_NEAR(r.charts[0].texels_per_unit.x, 4, 1e-12);
  EXPECT_NEAR(r.charts[0].texels_per_unit.y, 16, 1e-12);
  EXPECT_EQ(r.charts[1].content, ChartContent::unlit);
  EXPECT_EQ(r.charts[1].width, 16);
  EXPECT_EQ(r.charts[1].height, 10);  // it is already smaller
  EXPECT_EQ(r.charts[2].content, ChartContent::unlit);
  EXPECT_EQ(r.uniform, 1u);
  EXPECT_EQ(r.unlit, 2u);
  EXPECT_EQ(r.max_error, 0);
  EXPECT_EQ(r.final_texels, 16 * 16 + 16 * 10 + 16 * 16);
  EXPECT_EQ(r.full_texels, 400 * 100 + 400 * 10 + 400 * 400);
}

TEST(ChartTextures, FollowFinerDiffuseTexturesAndNoCoarserOnes) {
  const auto textured = [](float repeats) {
    LitShape shape = make_sheet({1, 1, 2, 2}, [](double, double) { return shown(0.5); });
    Image8 image(64, 64, 3);
    for (std::size_t i = 0; i < image.texels.size(); ++i)
      image.texels[i] = static_cast<std::uint8_t>(i * 37);
    add_texture(shape, image, {repeats, repeats});
    return shape;
  };
  const TextureResult fine = size_textures(textured(8), options(0.01));
  EXPECT_NEAR(fine.charts[0].full_texels_per_unit.x, 512, 1e-3);
  EXPECT_EQ(fine.raised, 1u);
  const TextureResult coarse = size_textures(textured(1), options(0.01));
  EXPECT_EQ(coarse.charts[0].full_texels_per_unit.x, 100);
  EXPECT_EQ(coarse.raised, 0u);
  TextureOptions finer = options(0.01);
  finer.texture_sampling = 1.5;
  EXPECT_NEAR(size_textures(textured(8), finer).charts[0].full_texels_per_unit.x, 768, 1e-3);
  TextureOptions own = options(0.01);
  own.follow_textures = false;
  EXPECT_EQ(size_textures(textured(8), own).charts[0].full_texels_per_unit.x, 100);
}

TEST(ChartTextures, FitThePage) {
  const LitShape shape =
      make_sheet({100, 1, 50, 1}, [](double u, double) { return shown(u / 100); });
  TextureOptions o = options(0.01, 0);
  o.max_side = 1000;
  const TextureResult r = size_textures(shape, o);
  EXPECT_TRUE(r.charts[0].capped);
  EXPECT_EQ(r.capped, 1u);
  EXPECT_EQ(r.charts[0].full_width, 1000);
  EXPECT_EQ(r.charts[0].full_height, 10);
}

TEST(ChartTextures, HalveARampAsOftenAsItsSlopeAllows) {
  // Display values rise by `step` per texel along u. At halving k (0, 1, ...) the texels of a quad
  // then differ from its mean by 2^k step / 2, which is allowed while it is below the threshold.
  for (const double step : {0.0006, 0.0011, 0.0021, 0.0041, 0.0077, 0.0163}) {
    const int n = 256;
    // With a vertex at every texel centre, display values are linear in between.
    const LitShape shape = make_sheet({1, 1, 2 * n, 1}, [&](double u, double) {
      return shown(std::min(1.0, step * u * n / 4 + 0.2));
    });
    int want = 0;
    while (want < 4 && step / 4 * std::ldexp(0.5, want) < 2.0 / 255) ++want;
    const ChartTexture t = size_textures(shape, options(1.0 / n)).charts[0];
    EXPECT_EQ(t.halvings, want) << step;
    EXPECT_EQ(t.width, n >> want);
    EXPECT_EQ(t.height, n >> want);
    EXPECT_EQ(t.texels_per_unit.x, n >> want);
    // Up-sampling reproduces a linear ramp, except at the ends, where half a coarse texel is
    // missing.
    EXPECT_LE(t.max_error, step / 4 * (std::ldexp(0.5, want) - 0.5) + 1e-4);
    EXPECT_LE(t.rms_error, t.max_error);
  }
}

// Half of the sheet is even below white, and the light of the other half varies far above it.
TEST(ChartTextures, KeepLightAboveWhiteIfPagesHoldIt) {
  const LitShape shape = make_sheet({1, 1, 64, 64}, [](double u, double v) {
    const auto lit =
        static_cast<float>(u < 0.5 ? 2 : 50 + 40 * std::sin(60 * u) * std::cos(50 * v));
    return Vec3f{lit, lit, lit};
  });
  TextureOptions o = options(1.0 / 256);
  const ChartTexture clipped = size_textures(shape, o).charts[0];
  EXPECT_EQ(clipped.width, 16) << "all of it is white";
  o.brightest = 90;
  const ChartTexture kept = size_textures(shape, o).charts[0];
  EXPECT_GE(kept.width, 128);
  EXPECT_LE(kept.max_error, 2 * o.threshold + 1e-6);
  // What is nowhere above white is sized as without it.
  const LitShape dim = make_sheet({1, 1, 64, 64}, [](double u, double) { return shown(u / 2); });
  o.brightest = 0;
  const ChartTexture without = size_textures(dim, o).charts[0];
  o.brightest = 90;
  EXPECT_EQ(size_textures(dim, o).charts[0].width, without.width);
}

TEST(ChartTextures, SayWhatTheirErrorCovers) {
  const auto ramp = [](double u, double) { return shown(u); };
  LitShape shape = make_sheet({1, 1, 30, 30}, ramp);
  append(shape, make_sheet({3, 3, 2, 2}, [](double, double) { return Vec3f{1, 1, 1}; }), {0, 0, 1});
  append(shape, make_sheet({1, 0.1, 9, 9}, ramp), {0, 0, 2});  // 10 texels high
  const TextureResult r = size_textures(shape, options(0.01, 0.1));
  EXPECT_TRUE(r.charts[0].sampled);
  EXPECT_FALSE(r.charts[1].sampled) << "of one colour";
  EXPECT_FALSE(r.charts[2].sampled) << "too small to halve";
  EXPECT_EQ(r.sampled, 1u);
  EXPECT_EQ(r.sampled_texels, 100 * 100);
  EXPECT_GT(r.rms_error, 0);
  EXPECT_NEAR(r.rms_error, r.charts[0].rms_error, 1e-7);
  EXPECT_GE(r.max_error, r.rms_error);
  EXPECT_EQ(r.max_error, r.charts[0].max_error);
  EXPECT_GT(r.charts[0].halvings, 0);
  EXPECT_EQ(r.halved, 1u);
}

TEST(ChartTextures, DoNotDependOnTheNumberOfThreads) {
  LitShape shape = make_sheet({1, 1, 40, 40, 0.3}, [](double u, double v) { return shown(u * v); });
  for (int i = 1; i < 12; ++i)
    append(shape,
           make_sheet({1, 1.0 / i, 30, 30, 0.3},
                      [i](double u, double v) { return shown(0.1 + 0.002 * i * (u + v)); }),
           {0, 0, static_cast<float>(i)});
  const TextureResult one = size_textures(shape, options(0.005), 1);
  const TextureResult four = size_textures(shape, options(0.005), 4);
  EXPECT_EQ(one.rms_error, four.rms_error);
  EXPECT_EQ(one.final_texels, four.final_texels);
  for (std::size_t i = 0; i < one.charts.size(); ++i) {
    EXPECT_EQ(one.charts[i].width, four.charts[i].width);
    EXPECT_EQ(one.charts[i].rms_error, four.charts[i].rms_error);
  }
}

TEST(ChartTextures, RefuseOptionsOutOfRange) {
  const LitShape shape = make_sheet({1, 1, 1, 1}, [](double, double) { return shown(1); });
  const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
  const auto refused = [&](auto change) {
    TextureOptions o;
    change(o);
    const auto r = size_chart_textures({sampler, shape.charts, kPlain}, o, Context{});
    return !r.ok() && r.status().code() == ErrorCode::bad_option;
  };
  EXPECT_TRUE(refused([](TextureOptions& o) { o.texel = 0; }));
  EXPECT_TRUE(refused([](TextureOptions& o) { o.texel = NAN; }));
  EXPECT_TRUE(refused([](TextureOptions& o) { o.threshold = NAN; }));
  EXPECT_TRUE(refused([](TextureOptions& o) { o.min_side = 0; }));
  EXPECT_TRUE(refused([](TextureOptions& o) { o.max_side = 4; }));
  EXPECT_TRUE(refused([](TextureOptions& o) { o.texture_sampling = 0; }));
  EXPECT_TRUE(refused([](TextureOptions& o) { o.texture_sampling = INFINITY; }));
  EXPECT_TRUE(refused([](TextureOptions& o) { o.texel = 1e-310; }));  // 1 / texel is infinite
}

TEST(ChartTextures, RefuseLightThatIsNotFinite) {
  LitShape shape = make_sheet({1, 1, 4, 4}, [](double u, double) { return shown(u); });
  const auto status = [&] {
    const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
    return size_chart_textures({sampler, shape.charts, kPlain}, {}, Context{}).status();
  };
  EXPECT_TRUE(status().ok());
  shape.scene.illumination[7] = {1e35f, 1e35f, 1e35f};
  EXPECT_TRUE(status().ok());
  shape.scene.materials[0].diffuse.x = 1e3f;
  EXPECT_EQ(status().code(), ErrorCode::bad_input);
  EXPECT_NE(status().message().find("vertex 7 "), std::string::npos) << status().message();
  shape.scene.illumination[7].x = NAN;
  EXPECT_EQ(status().code(), ErrorCode::bad_input);
  shape.scene.illumination[7].x = -INFINITY;
  EXPECT_EQ(status().code(), ErrorCode::bad_input);
}

TEST(ChartTextures, StopWhenCancelled) {
  const LitShape shape = make_sheet({1, 1, 4, 4}, [](double u, double) { return shown(u); });
  const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
  const std::atomic<bool> stop{true};
  Context context;
  context.cancel = &stop;
  const auto r = size_chart_textures({sampler, shape.charts, kPlain}, {}, context);
  EXPECT_EQ(r.status().code(), ErrorCode::cancelled);
}

// --- The halving itself, on random textures with holes, compared with the definition ---

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

// Returns the largest error of the interpolated texture, over covered texels. Only covered texels
// of the small one are interpolated.
double interpolation_error(const SampledChart& full, const SampledChart& small, int halvings) {
  double worst = 0;
  for (int y = 0; y < full.height; ++y)
    for (int x = 0; x < full.width; ++x) {
      const auto& wanted = full.texels[std::size_t(y) * full.width + x];
      if (!(wanted.weight > 0)) continue;
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
      for (int k = 0; k < 3; ++k)
        worst = std::max(worst, std::fabs(sum[k] / weights - wanted.rgb[k]));
    }
  return worst;
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
      const double error = interpolation_error(full, levels.back(), int(levels.size()) - 1);
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
