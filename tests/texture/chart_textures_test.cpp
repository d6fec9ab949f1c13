#include "libatlas/texture/chart_textures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "tests/support/lit_shapes.h"

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
  for (const double no_light : {-1.0, double(NAN), double(INFINITY)})
    EXPECT_TRUE(refused([&](TextureOptions& o) { o.brightest = no_light; })) << no_light;
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

}  // namespace
}  // namespace atlas
