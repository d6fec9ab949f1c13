// Compares rows of samples with samples taken one by one.
#include "libatlas/texture/light_row.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "libatlas/texture/triangle_light.h"
#include "tests/support/lit_shapes.h"

namespace atlas {
namespace {

TEST(LightRow, EncodesAsOneByOne) {
  const float inf = std::numeric_limits<float>::infinity();
  const float special[] = {0,          -0.0f, 1,     1.0f / 512,
                           0.0031308f, -3,    7,     1e-30f,
                           inf,        -inf,  1e38f, std::numeric_limits<float>::quiet_NaN()};
  std::mt19937 random(1);
  for (int n = 0; n < 40; ++n) {
    std::vector<Lanes> colours(static_cast<std::size_t>(n));
    for (Lanes& c : colours)
      for (int k = 0; k < 4; ++k)
        c[k] = random() % 4 ? std::pow(static_cast<float>(random() % 1000) / 999, 3.0f)
                            : special[random() % std::size(special)];
    const std::vector<Lanes> before = colours;
    srgb_encode_row(0.75f, n, colours.data());
    for (std::size_t i = 0; i < colours.size(); ++i) {
      const Lanes one = srgb_encode_lanes(before[i] * 0.75f);
      for (int k = 0; k < 3; ++k) {
        ASSERT_EQ(colours[i][k], one[k]) << before[i][k];
        ASSERT_EQ(colours[i][k], srgb_encode(before[i][k] * 0.75f)) << before[i][k];
      }
      ASSERT_EQ(colours[i][3], 1);
    }
  }
}

// Multiplies n colours by the texture at the row's positions, and expects what one look-up after
// another gives.
void expect_as_one_by_one(const TextureRow& row, int n) {
  std::vector<Lanes> colours(static_cast<std::size_t>(n), Lanes{1, 2, 3, 1});
  multiply_by_texture(row, n, colours.data());
  for (int i = 0; i < n; ++i) {
    const auto f = static_cast<float>(row.first + i);
    const Vec2f at{row.at.x + f * row.step.x, row.at.y + f * row.step.y};
    const Lanes one = look_up(row.level, at, row.wraps);
    for (int k = 0; k < 3; ++k)
      ASSERT_NEAR(colours[i][k], (k + 1) * one[k], 1e-5) << at.x << ' ' << at.y;
  }
}

TEST(LightRow, LooksUpAsOneByOne) {
  std::mt19937 random(2);
  for (const int channels : {1, 2, 3, 4}) {
    Texture texture;
    texture.image = Image8(7, 5, channels);
    for (auto& t : texture.image.texels) t = static_cast<std::uint8_t>(random());
    TextureLevels levels(texture);
    if (channels % 2 == 0) levels.decode();
    for (const TextureWrap wrap : {TextureWrap::repeat, TextureWrap::mirror, TextureWrap::clamp})
      for (int n = 0; n < 20; ++n) {
        const TextureRow row{
            levels.levels[0], {wrap, TextureWrap::repeat}, {-1.3f, 2.1f}, {0.7f, -0.3f}, n};
        expect_as_one_by_one(row, n);
        // Short steps from each edge, so that rows of four samples lie close to one edge and far
        // from the others.
        for (const Vec2f step : {Vec2f{0.1f, 0.05f}, Vec2f{-0.05f, 0.1f}})
          for (const Vec2f at : {Vec2f{6.2f, 2}, Vec2f{0.4f, 2}, Vec2f{3, 4.2f}, Vec2f{3, 0.4f}})
            expect_as_one_by_one({levels.levels[0], {wrap, wrap}, at, step, 0}, n);
      }
  }
}

// Tests where the tone curve is approximated by line segments: from dark to beyond white, in steep
// and in flat light.
TEST(LightRow, ShowsLightAsTheToneCurveDoes) {
  std::mt19937 random(3);
  const auto uniform = [&](double most) { return most * (random() % 100000) / 99999.0; };
  for (const ToneOperator op : {ToneOperator::linear, ToneOperator::reinhard, ToneOperator::drago})
    for (int trial = 0; trial < 300; ++trial) {
      ToneMapping tone;
      tone.op = op;
      if (op != ToneOperator::linear) tone.white = 4;
      tone.parameter[0] = 0.2f;
      tone.parameter[1] = 1.4f;
      LuminanceSampler::Triangle triangle{};
      const double base = uniform(1.1), spread = std::pow(uniform(1), 4);
      for (auto& corner : triangle.illumination)
        for (int k = 0; k < 3; ++k)
          corner[k] = static_cast<float>(base * base + spread * (uniform(1) - 0.2));
      TriangleLight light(triangle, &tone);
      const TexelTriangle p{Vec2d{0, 0}, Vec2d{70, 0}, Vec2d{uniform(60), 40}};
      light.set_position(p);
      const double y = 1 + uniform(30), x0 = p[2].x * y / 40, x1 = x0 + 70 * (1 - y / 40);
      light.row({x0, y}, static_cast<int>(x1 - x0), [&](int first, const Lanes* shown, int n) {
        for (int i = 0; i < n; ++i) {
          const double x = x0 + first + i, b2 = y / 40, b1 = (x - b2 * p[2].x) / 70;
          const Vec3f want = tone.display(
              LuminanceSampler::sample(triangle, static_cast<float>(1 - b1 - b2),
                                       static_cast<float>(b1), static_cast<float>(b2)));
          ASSERT_NEAR(shown[i][0], want.x, 0.25 / 255) << trial << ' ' << first + i;
          ASSERT_NEAR(shown[i][1], want.y, 0.25 / 255) << trial << ' ' << first + i;
          ASSERT_NEAR(shown[i][2], want.z, 0.25 / 255) << trial << ' ' << first + i;
          ASSERT_EQ(shown[i][3], 1);
        }
      });
    }
}

}  // namespace
}  // namespace atlas
