// Textures of single charts, on triangles larger and smaller than texels.
#include "libatlas/texture/sample_chart.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/lit_shapes.h"

namespace atlas {
namespace {

// The mean over a texel of light that rises evenly is the light at the texel's centre.
TEST(SampleChart, HoldsEachTexelsLight) {
  const ToneMapping tone{};
  const auto at = [](double u, double v) {
    return Vec3f{float(0.2 + 0.5 * u), float(0.1 + 0.6 * v), float(0.3 + 0.2 * u + 0.4 * v)};
  };
  for (const int cells : {2, 13, 150}) {  // 150: more than seven cells across each texel
    const LitShape shape = make_sheet({1, 1, cells, cells, 0.2}, at);
    const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
    SampledChart chart;
    sample_chart({sampler, shape.charts, tone}, 0, 20, chart);
    ASSERT_EQ(chart.width, 20);
    ASSERT_EQ(chart.height, 20);
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 20; ++x) {
        const SampledChart::Texel& texel = chart.texels[std::size_t(y) * 20 + x];
        const Vec3f want = tone.display(at((x + 0.5) / 20, (y + 0.5) / 20));
        // Small triangles count with their area where their middle lies.
        const double slack = cells == 2 ? 1e-3 : cells == 150 ? 0.01 : 0.025;
        if (cells == 2) {
          ASSERT_EQ(texel.weight, 1) << x << ' ' << y;
        }
        ASSERT_GT(texel.weight, cells == 150 ? 0.8 : 0.2) << x << ' ' << y;
        ASSERT_NEAR(texel.rgb[0], want.x, slack) << cells << ' ' << x << ' ' << y;
        ASSERT_NEAR(texel.rgb[1], want.y, slack) << cells << ' ' << x << ' ' << y;
        ASSERT_NEAR(texel.rgb[2], want.z, slack) << cells << ' ' << x << ' ' << y;
      }
  }
}

}  // namespace
}  // namespace atlas
