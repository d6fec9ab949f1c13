#include "libatlas/texture/luminance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "libatlas/core/srgb.h"
#include "tests/support/lit_shapes.h"

namespace atlas {
namespace {

Image8 noise_image(int width, int height, int channels) {
  Image8 image(width, height, channels);
  std::mt19937 random(3);
  for (auto& t : image.texels) t = static_cast<std::uint8_t>(random());
  return image;
}

double decode(int code) {
  const double d = code / 255.0;
  return d <= 0.04045 ? d / 12.92 : std::pow((d + 0.055) / 1.055, 2.4);
}

// Returns the texel (0 to n - 1) that stands for texel i, by the definitions of OpenGL.
long texel_of(long i, long n, TextureWrap wrap) {
  if (wrap == TextureWrap::clamp) return std::clamp(i, 0l, n - 1);
  const long cycle = i - n * std::lround(std::floor(double(i) / double(n)));
  const bool mirrored =
      wrap == TextureWrap::mirror && std::lround(std::floor(double(i) / double(n))) % 2 != 0;
  return mirrored ? n - 1 - cycle : cycle;
}

// A bilinear look-up that follows the definition.
double texel_value(const Image8& image, Vec2d uv, const Material& material, int channel) {
  const double u = uv.x, v = uv.y;
  const double x = u * image.width - 0.5, y = v * image.height - 0.5;
  double sum = 0;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const long cx = std::lround(std::floor(x)) + i, cy = std::lround(std::floor(y)) + j;
      const double w = (1 - std::fabs(x - static_cast<double>(cx))) *
                       (1 - std::fabs(y - static_cast<double>(cy)));
      const long px = texel_of(cx, image.width, material.wrap_u);
      const long py = texel_of(cy, image.height, material.wrap_v);
      const int c = image.channels >= 3 ? channel : 0;
      sum += w * decode(image.at(static_cast<int>(px), static_cast<int>(py))[c]);
    }
  return sum;
}

TEST(LuminanceSampler, IsIlluminationTimesReflectance) {
  constexpr TextureWrap kWraps[] = {TextureWrap::repeat, TextureWrap::mirror, TextureWrap::clamp};
  for (const int channels : {1, 2, 3, 4})
    for (const Vec2f repeats : {Vec2f{3.3f, 2.7f}, Vec2f{-5.1f, 0.9f}}) {
      LitShape shape = make_sheet({2, 1, 5, 4, 0.2, {0.5f, 0.25f, 1}}, [](double u, double v) {
        return Vec3f{static_cast<float>(u), static_cast<float>(v + 1), 7};
      });
      const Image8 image = noise_image(13, 8, channels);
      add_texture(shape, image, repeats);
      Material& material = shape.scene.materials[0];
      material.wrap_u = kWraps[channels % 3];
      material.wrap_v = kWraps[(channels + (repeats.x > 0)) % 3];
      const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
      const float diffuse[3] = {0.5f, 0.25f, 1};
      std::mt19937 random(4);
      for (std::uint32_t t = 0; t < shape.scene.triangle_count(); ++t)
        for (int n = 0; n < 20; ++n) {
          double b[3] = {(random() % 1000) / 1000.0, 0, 0};
          b[1] = (1 - b[0]) * (random() % 1000) / 1000.0;
          b[2] = 1 - b[0] - b[1];
          double x = 0, y = 0, e[3] = {0, 0, 0};
          for (int k = 0; k < 3; ++k) {
            const std::uint32_t i = shape.scene.indices[3 * t + k];
            x += b[k] * shape.scene.positions[i].x;
            y += b[k] * shape.scene.positions[i].y;
            const Vec3f l = shape.scene.illumination[i];
            e[0] += b[k] * l.x, e[1] += b[k] * l.y, e[2] += b[k] * l.z;
          }
          const Vec3f got =
              LuminanceSampler::sample(sampler.prepare(t, 0), static_cast<float>(b[0]),
                                       static_cast<float>(b[1]), static_cast<float>(b[2]));
          const float g[3] = {got.x, got.y, got.z};
          for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(
                g[c],
                e[c] * diffuse[c] * texel_value(image, {x * repeats.x, y * repeats.y}, material, c),
                2e-4);
        }
    }
}

TEST(LuminanceSampler, LeavesReflectanceAloneWhenGivenLuminance) {
  LitShape shape = make_sheet({1, 1, 1, 1, 0, {0.1f, 0.1f, 0.1f}}, [](double, double) {
    return Vec3f{3, 4, 5};
  });
  add_texture(shape, noise_image(8, 8, 3), {1, 1});
  const LuminanceSampler sampler(shape.scene, Quantity::luminance);
  EXPECT_EQ(LuminanceSampler::sample(sampler.prepare(0, 0), 1, 0, 0), (Vec3f{3, 4, 5}));
  EXPECT_EQ(sampler.texture_density(0), 0);
  EXPECT_TRUE(sampler.prepare(1, 0).constant);
}

TEST(LuminanceSampler, TakesIlluminationAsOneWhereThereIsNone) {
  LitShape shape =
      make_sheet({1, 1, 1, 1, 0, {0.2f, 0.4f, 0.6f}}, [](double, double) { return Vec3f{}; });
  shape.scene.illumination.clear();
  const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
  EXPECT_EQ(LuminanceSampler::sample(sampler.prepare(0, 0), 0, 1, 0), (Vec3f{0.2f, 0.4f, 0.6f}));
}

TEST(LuminanceSampler, KnowsHowFineATextureIsOnTheSurface) {
  LitShape shape = make_sheet({4, 2, 2, 2}, [](double, double) { return Vec3f{1, 1, 1}; });
  add_texture(shape, noise_image(64, 16, 3), {0.5f, 4});  // 32 x 64 texels per unit
  const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
  for (std::uint32_t t = 0; t < shape.scene.triangle_count(); ++t)
    EXPECT_NEAR(sampler.texture_density(t), std::sqrt(32.0 * 64.0), 1e-3);
}

TEST(LuminanceSampler, TexturesHaveNoFinenessOnTrianglesWithoutArea) {
  LitShape shape = make_sheet({4, 2, 2, 2}, [](double, double) { return Vec3f{1, 1, 1}; });
  add_texture(shape, noise_image(64, 16, 3), {0.5f, 4});
  LitShape squeezed = shape;
  for (Vec3f& p : squeezed.scene.positions) p.y = 0;
  for (Vec2f& p : shape.scene.texcoords) p.y = 0;
  for (const LitShape& s : {shape, squeezed}) {
    const LuminanceSampler sampler(s.scene, Quantity::illuminance);
    for (std::uint32_t t = 0; t < s.scene.triangle_count(); ++t)
      EXPECT_EQ(sampler.texture_density(t), 0) << t;
  }
}

TEST(LuminanceSampler, FindsTheCornerWhoseLightIsNoNumber) {
  LitShape shape = make_sheet({1, 1, 1, 1}, [](double, double) { return Vec3f{1, 1, 1}; });
  std::vector<Vec3f>& light = shape.scene.illumination;
  for (int corner = 0; corner < 3; ++corner) {
    for (int channel = 0; channel < 3; ++channel) {
      light.assign(light.size(), {1, 1, 1});
      Vec3f& there = light[shape.scene.indices[corner]];
      (channel == 0 ? there.x : channel == 1 ? there.y : there.z) = channel == 1 ? NAN : -1e37f;
      const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
      EXPECT_EQ(sampler.bad_corner(0), corner) << channel;
    }
  }
  light.assign(light.size(), {1e36f, -1e36f, 0});
  EXPECT_EQ(LuminanceSampler(shape.scene, Quantity::illuminance).bad_corner(0), 3);
}

TEST(LuminanceSampler, ReadsCoarserLevelsForWiderSamples) {
  // A checkerboard of black and white texels: every coarser level is their mean in linear light.
  Image8 image(64, 64, 3);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      for (int k = 0; k < 3; ++k) image.at(x, y)[k] = (x + y) % 2 ? 255 : 0;
  LitShape shape = make_sheet({1, 1, 1, 1}, [](double, double) { return Vec3f{1, 1, 1}; });
  add_texture(shape, image, {1, 1});
  const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
  EXPECT_EQ(sampler.prepare(0, 0).level, 0);
  EXPECT_EQ(sampler.prepare(0, 1.0 / 64).level, 0);
  EXPECT_EQ(sampler.prepare(0, 2.0 / 64).level, 1);
  EXPECT_EQ(sampler.prepare(0, 4.2 / 64).level, 2);
  EXPECT_EQ(sampler.prepare(0, 1e9).level, 6);
  for (const double spacing : {2.0 / 64, 8.0 / 64, 1e9})
    EXPECT_NEAR(LuminanceSampler::sample(sampler.prepare(0, spacing), 0.3f, 0.3f, 0.4f).x, 0.5,
                0.003);
}

TEST(LuminanceSampler, AveragesLevelsOfOddSizes) {
  // One texel is white. Every level must keep the mean over the whole texture, and the last level
  // is a single texel.
  constexpr int kSizes[][2] = {{5, 3}, {8, 2}, {2, 8}, {3, 9}};
  for (const auto& [width, height] : kSizes) {
    Image8 image(width, height, 1);
    image.at(width / 2, height / 2)[0] = 255;
    LitShape shape = make_sheet({1, 1, 1, 1}, [](double, double) { return Vec3f{1, 1, 1}; });
    shape.scene.materials[0].wrap_u = shape.scene.materials[0].wrap_v = TextureWrap::clamp;
    add_texture(shape, image, {1, 1});
    const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
    const auto coarsest = sampler.prepare(0, 1e9);
    for (const Vec2f b : {Vec2f{0, 0}, Vec2f{1, 0}, Vec2f{0, 1}})
      EXPECT_NEAR(LuminanceSampler::sample(coarsest, 1 - b.x - b.y, b.x, b.y).x,
                  1.0 / (width * height), 0.002)
          << width << ' ' << height;
  }
}

TEST(LuminanceSampler, GivesTheMeanWhereCoordinatesAreBeyondPrecision) {
  LitShape shape = make_sheet({1, 1, 1, 1}, [](double, double) { return Vec3f{1, 1, 1}; });
  Image8 image(2, 2, 1);
  image.texels = {255, 0, 0, 255};
  for (const float repeats : {1e9f, -1e30f, 3e38f}) {
    shape.scene.materials[0].wrap_u = repeats < 0 ? TextureWrap::clamp : TextureWrap::mirror;
    add_texture(shape, image, {repeats, repeats});
    const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
    const Vec3f c = LuminanceSampler::sample(sampler.prepare(0, 0), 0.2f, 0.3f, 0.5f);
    EXPECT_NEAR(c.x, 0.5, 0.003) << repeats;
  }
}

TEST(LuminanceSampler, TreatsATriangleWithoutCoordinatesAsUntextured) {
  LitShape shape = make_sheet({1, 1, 1, 1}, [](double, double) { return Vec3f{2, 2, 2}; });
  add_texture(shape, noise_image(4, 4, 3), {1, 1});
  shape.scene.texcoord_indices[4] = Scene::kNoTexcoord;
  const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
  EXPECT_FALSE(sampler.prepare(0, 0).constant);
  EXPECT_TRUE(sampler.prepare(1, 0).constant);
  EXPECT_EQ(LuminanceSampler::sample(sampler.prepare(1, 0), 0.2f, 0.3f, 0.5f), (Vec3f{2, 2, 2}));
}

}  // namespace
}  // namespace atlas
