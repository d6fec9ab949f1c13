#include "libatlas/bake/bake.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>

#include "tests/bake/bake_fixture.h"
#include "tests/support/broken_charts.h"

namespace atlas {
namespace {

// Display values a + b u + c v.
struct Ramp {
  double a, b, c;
};

// The errors over all points of a chart with such values, looked up in the page.
struct WorstErrors {
  double inside = 0, border = 0;  // at least a texel from the border; nearer
};

WorstErrors ramp_errors(const Image8& page, const ChartPlacement& p, Vec2d size, const Ramp& ramp) {
  std::mt19937 random(5);
  WorstErrors worst;
  for (int i = 0; i < 20000; ++i) {
    Vec2d uv{size.x * (random() % 10001) / 10000.0, size.y * (random() % 10001) / 10000.0};
    if (i % 10 == 0) uv.x = i % 20 ? 0 : size.x;  // exactly on the border
    if (i % 15 == 0) uv.y = i % 30 ? 0 : size.y;
    const double want = ramp.a + ramp.b * uv.x + ramp.c * uv.y;
    const double error = std::fabs(look_up(page, page_texel(p, uv), 1) / 255 - want);
    const double to_border =
        std::min({uv.x * p.texels_per_unit.x, uv.y * p.texels_per_unit.y,
                  (size.x - uv.x) * p.texels_per_unit.x, (size.y - uv.y) * p.texels_per_unit.y});
    double& most = to_border < 1 ? worst.border : worst.inside;
    most = std::max(most, error);
  }
  return worst;
}

TEST(BakePage, ReproducesALinearRampUpToTheBorder) {
  // The values are linear in display space over fine cells, so the texels form the ramp itself,
  // also beyond the border.
  const Vec2d size{1.37, 0.61};
  for (const int cells : {25, 60, 300})  // triangles of 3, 1 and 0.2 texels
    for (const bool rotated : {false, true})
      for (const Vec2d density : {Vec2d{53.3, 53.3}, Vec2d{61.7, 40.1}}) {
        const LitShape shape =
            make_sheet({size.x, size.y, cells, cells, 0.2},
                       [](double u, double v) { return shown(0.1 + 0.3 * u + 0.5 * v); });
        const ChartPlacement p = place(shape.charts, 0, density, {6, 10, rotated});
        BakeOptions options = small_page(128);
        for (const int levels : {options.mip_levels, 0}) {
          options.mip_levels = levels;
          const auto page = bake(shape, {p}, options);
          ASSERT_TRUE(page.ok());
          const WorstErrors worst = ramp_errors(page->display, p, size, {0.1, 0.3, 0.5});
          EXPECT_LE(worst.inside, 0.75 / 255) << cells << ' ' << rotated << ' ' << density.x;
          EXPECT_LE(worst.border, 1.2 / 255) << cells << ' ' << rotated << ' ' << density.x;
        }
      }
}

TEST(BakePage, AverageReproducesARampInside) {
  const LitShape shape = make_sheet(
      {1, 1, 80, 80, 0.2}, [](double u, double v) { return shown(0.1 + 0.3 * u + 0.5 * v); });
  const ChartPlacement p = place(shape.charts, 0, {50, 50}, {4, 4});
  const auto page = bake(shape, {p}, small_page(64, BakeMethod::average));
  ASSERT_TRUE(page.ok());
  for (double v = 0.05; v < 0.95; v += 0.013)
    for (double u = 0.05; u < 0.95; u += 0.017)
      ASSERT_NEAR(look_up(page->display, page_texel(p, {u, v}), 0) / 255, 0.1 + 0.3 * u + 0.5 * v,
                  1.0 / 255);
}

// Tone curves other than the linear one are applied to the colour of each sample, that is to the
// light or to its product with a texture. Tests large triangles and ones that no sample position
// meets.
TEST(BakePage, ShowsLightAndTexturesThroughAnyToneCurve) {
  LuminanceStatistics statistics;
  statistics.log_average = statistics.middle = 0.5;
  statistics.maximum = statistics.percentile98 = 4;
  statistics.mean_rgb = {0.6f, 0.6f, 0.6f};
  statistics.minimum_log = std::log(0.05);
  statistics.maximum_log = std::log(4);
  const Light at = [](double u, double v) {
    return Vec3f{float(0.2 + 2 * u), float(1 + v), float(0.5 + 0.3 * u + 0.4 * v)};
  };
  for (const ToneOperator op : {ToneOperator::linear, ToneOperator::reinhard, ToneOperator::drago,
                                ToneOperator::reinhard_devlin}) {
    ToneOptions how;
    how.op = op;
    const auto tone = make_tone_mapping(how, statistics);
    ASSERT_TRUE(tone.ok());
    for (const bool textured : {false, true}) {
      for (const int cells : {4, 120}) {  // 120: six cells per texel
        LitShape shape = make_sheet({1, 1, cells, cells}, at);
        if (textured) add_texture(shape, Image8(8, 8, 3, 170), {3, 3});
        const float reflectance = textured ? srgb_decode(170.0f / 255) : 1;
        const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
        const ChartPlacement p = place(shape.charts, 0, {20, 20}, {4, 4});
        for (const BakeMethod method : {BakeMethod::least_squares, BakeMethod::average}) {
          const auto page = bake_page({sampler, shape.charts, *tone}, std::vector{p},
                                      small_page(32, method), Context{});
          ASSERT_TRUE(page.ok());
          for (int y = 1; y < 19; ++y)
            for (int x = 1; x < 19; ++x) {
              const Vec3f light = at((x + 0.5) / 20, (y + 0.5) / 20);
              const Vec3f want = tone->display(
                  {reflectance * light.x, reflectance * light.y, reflectance * light.z});
              const std::uint8_t* got = page->display.at(x + 4, y + 4);
              ASSERT_NEAR(got[0], 255 * want.x, 2) << tone_operator_name(op) << ' ' << cells;
              ASSERT_NEAR(got[1], 255 * want.y, 2) << tone_operator_name(op) << ' ' << cells;
              ASSERT_NEAR(got[2], 255 * want.z, 2) << tone_operator_name(op) << ' ' << cells;
            }
        }
      }
    }
  }
}

TEST(BakePage, LeastSquaresIsNearerToTheLightThanTheAverage) {
  // The slanted edge of a soft shadow, a few texels wide, with fine noise.
  std::mt19937 random(9);
  const auto light = [&](double u, double v) {
    const double edge = 1 / (1 + std::exp(-(u + 0.37 * v - 0.6) * 60));
    return shown(0.2 + 0.6 * edge + 0.05 * (random() % 100) / 100.0);
  };
  const LitShape shape = make_sheet({1, 1, 50, 50, 0.2}, light);
  const ChartPlacement p = place(shape.charts, 0, {64, 64}, {4, 4});
  const ChartPlacement fine = place(shape.charts, 0, {960, 960}, {8, 8});
  const auto truth = bake(shape, {fine}, small_page(1024));
  ASSERT_TRUE(truth.ok());
  double square[2] = {0, 0};
  for (int m = 0; m < 2; ++m) {
    const auto page =
        bake(shape, {p}, small_page(128, m ? BakeMethod::average : BakeMethod::least_squares));
    ASSERT_TRUE(page.ok());
    for (int j = 0; j < 640; ++j)
      for (int i = 0; i < 640; ++i) {
        const Vec2d uv{(i + 0.5) / 640, (j + 0.5) / 640};
        const double d = look_up(page->display, page_texel(p, uv), 0) -
                         look_up(truth->display, page_texel(fine, uv), 0);
        square[m] += d * d;
      }
  }
  EXPECT_LT(square[0], 0.7 * square[1]);
}

TEST(BakePage, GivesSceneLinearValuesOnRequest) {
  const LitShape shape = make_sheet({1, 1, 20, 20}, [](double u, double v) {
    return Vec3f{static_cast<float>(100 * u), static_cast<float>(5000 * v), 0.25f};
  });
  const ChartPlacement p = place(shape.charts, 0, {40, 40}, {4, 4});
  BakeOptions options = small_page(64);
  options.linear = true;
  for (const BakeMethod method : {BakeMethod::least_squares, BakeMethod::average}) {
    options.method = method;
    const auto page = bake(shape, {p}, options);
    ASSERT_TRUE(page.ok());
    for (double v = 0.05; v < 0.95; v += 0.03)
      for (double u = 0.05; u < 0.95; u += 0.03) {
        const Vec2d at = page_texel(p, {u, v});
        ASSERT_NEAR(look_up(page->linear, at, 0), 100 * u, 0.05);
        ASSERT_NEAR(look_up(page->linear, at, 1), 5000 * v, 2.5);
        ASSERT_NEAR(look_up(page->linear, at, 2), 0.25, 1e-5);
      }
  }
  options.linear = false;
  EXPECT_TRUE(bake(shape, {p}, options)->linear.texels.empty());
}

// Values that are not light may be negative. Light may not, whatever the fit would do at edges.
TEST(BakePage, SceneLinearValuesAreNegativeOnlyWhereTheSignalIs) {
  const auto least_of = [](float base, int negative = -1) {
    LitShape shape = make_sheet({1, 1, 20, 20}, [&](double u, double) {
      const float v = base + (u < 0.5 ? 0.0f : 2.0f);
      return Vec3f{v, v, v};
    });
    if (negative >= 0) {  // one channel at one vertex
      Vec3f& e = shape.scene.illumination.back();
      (negative == 0 ? e.x : negative == 1 ? e.y : e.z) = -1e-3f;
    }
    const ChartPlacement p = place(shape.charts, 0, {40, 40}, {4, 4});
    BakeOptions options = small_page(64);
    options.linear = true;
    const auto page = bake(shape, {p}, options);
    EXPECT_TRUE(page.ok());
    EXPECT_NEAR(look_up(page->linear, page_texel(p, {0.2, 0.5}), 0), base, 1e-3);
    EXPECT_NEAR(look_up(page->linear, page_texel(p, {0.8, 0.5}), 0), base + 2, 1e-3);
    return *std::min_element(page->linear.texels.begin(), page->linear.texels.end());
  };
  EXPECT_LT(least_of(-1.5f), -1.5f);  // as far below the step as above it
  EXPECT_EQ(least_of(0), 0);
  for (int channel = 0; channel < 3; ++channel) EXPECT_LT(least_of(0, channel), -0.01f) << channel;
}

// A striped texture is read in the size of the samples: stripes of many texels are seen, and those
// finer than samples become their mean, without beating against them.
TEST(BakePage, ReadsTexturesInTheSizeOfItsSamples) {
  Image8 stripes(64, 64, 3);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) std::fill_n(stripes.at(x, y), 3, std::uint8_t(x % 2 ? 255 : 0));
  const auto extremes = [&](float repeats, BakeMethod method) {
    LitShape shape = make_sheet({1, 1, 1, 1}, [](double, double) {
      return Vec3f{0.8f, 0.8f, 0.8f};
    });
    add_texture(shape, stripes, {repeats, repeats});
    const ChartPlacement p = place(shape.charts, 0, {96, 96}, {4, 4});
    BakeOptions options = small_page(128, method);
    options.linear = true;
    const auto page = bake(shape, {p}, options);
    EXPECT_TRUE(page.ok());
    float low = 1, high = 0;
    for (int y = 20; y < 80; ++y)
      for (int x = 20; x < 80; ++x) {
        low = std::min(low, *page->linear.at(x, y));
        high = std::max(high, *page->linear.at(x, y));
      }
    return std::pair(low, high);
  };
  for (const BakeMethod method : {BakeMethod::least_squares, BakeMethod::average}) {
    const auto wide = extremes(0.125f, method);  // 12 texels a stripe
    EXPECT_LT(wide.first, 0.05f);
    EXPECT_GT(wide.second, 0.75f);
    const auto fine = extremes(96 * 4.3f / 32, method);  // 4.3 pairs of stripes a texel
    EXPECT_NEAR(fine.first, 0.4, 0.02);
    EXPECT_NEAR(fine.second, 0.4, 0.02);
  }
}

// A box that is narrower than its chart cuts off the chart's right part and leaves the left one.
TEST(BakePage, ABoxMayCutOffAPartOfItsChart) {
  const LitShape shape =
      make_sheet({1, 1, 9, 9}, [](double u, double v) { return shown(0.1 + 0.4 * u + 0.4 * v); });
  for (const BakeMethod method : {BakeMethod::least_squares, BakeMethod::average}) {
    ChartPlacement p = place(shape.charts, 0, {40, 40}, {4, 4});
    const auto whole = bake(shape, {p}, small_page(64, method));
    p.width -= 23;
    p.height -= 11;
    const auto cut = bake(shape, {p}, small_page(64, method));
    ASSERT_TRUE(whole.ok() && cut.ok());
    for (int y = p.y; y < p.y + p.height - 3; ++y)
      for (int x = p.x; x < p.x + p.width - 3; ++x)
        ASSERT_NEAR(cut->display.at(x, y)[0], whole->display.at(x, y)[0], 1) << x << ' ' << y;
  }
}

LitShape many_charts(std::vector<ChartPlacement>& placements) {
  LitShape shape;
  int x = 4, y = 4;
  for (int i = 0; i < 24; ++i) {
    const double w = 0.3 + 0.1 * (i % 5), h = 0.2 + 0.07 * (i % 7);
    append(shape,
           make_sheet({w, h, 3 + 4 * i, 5 + i, 0.3},
                      [i](double u, double v) { return shown(std::fmod(u * 3 + v * i, 1.0)); }),
           {0, 0, static_cast<float>(i)});
    placements.push_back(
        place(shape.charts, static_cast<std::uint32_t>(i), {60, 60}, {x, y, i % 3 == 0}));
    x += 52;
    if (x > 200) x = 4, y += 52;
  }
  return shape;
}

TEST(BakePage, IsTheSameForEveryNumberOfThreads) {
  std::vector<ChartPlacement> placements;
  const LitShape shape = many_charts(placements);
  BakeOptions options = small_page(320);
  options.linear = true;
  for (const BakeMethod method : {BakeMethod::least_squares, BakeMethod::average}) {
    options.method = method;
    const auto one = bake(shape, placements, options, 1),
               four = bake(shape, placements, options, 4);
    ASSERT_TRUE(one.ok() && four.ok());
    EXPECT_EQ(one->display.texels, four->display.texels);
    EXPECT_EQ(one->linear.texels, four->linear.texels);
    EXPECT_EQ(one->triangles, shape.scene.triangle_count());
    EXPECT_EQ(one->covered_texels, four->covered_texels);
  }
}

TEST(BakePage, TakesSliversAndTrianglesWithoutArea) {
  LitShape shape = make_sheet({1, 1, 12, 12}, [](double u, double v) { return shown(u * v); });
  std::mt19937 random(3);
  for (std::size_t i = 0; i < shape.charts.uvs.size(); i += 3) {
    Vec2d& q = shape.charts.uvs[i];
    const Vec2d& other = shape.charts.uvs[(i + 1) % shape.charts.uvs.size()];
    // Moves the point onto a neighbour, or nearly so.
    q = {other.x + (random() % 3) * 1e-13, other.y + (random() % 3) * 1e-9};
  }
  for (const BakeMethod method : {BakeMethod::least_squares, BakeMethod::average}) {
    BakeOptions options = small_page(64, method);
    options.linear = true;
    const auto page = bake(shape, {place(shape.charts, 0, {50, 50}, {4, 4})}, options);
    ASSERT_TRUE(page.ok());
    for (const float v : page->linear.texels) ASSERT_TRUE(v >= 0 && v <= 1.01f) << v;
  }
}

TEST(BakePage, RefusesWhatCannotBe) {
  const LitShape shape = make_sheet({1, 1, 2, 2}, [](double, double) { return shown(1); });
  const ChartPlacement good = place(shape.charts, 0, {20, 20}, {4, 4});
  const auto code = [&](auto change) {
    BakeOptions o = small_page(32);
    ChartPlacement p = good;
    change(o, p);
    return bake(shape, {p}, o).status().code();
  };
  using O = BakeOptions;
  using P = ChartPlacement;
  EXPECT_EQ(code([](O&, P&) {}), ErrorCode::ok);
  EXPECT_EQ(code([](O&, P& p) { p.x = 1; }), ErrorCode::bad_input);  // its padding leaves the page
  EXPECT_EQ(code([](O&, P& p) { p.y = 11; }), ErrorCode::bad_input);
  EXPECT_EQ(code([](O&, P& p) { p.x = 2147483647; }), ErrorCode::bad_input);
  EXPECT_EQ(code([](O&, P& p) { p.width = 0; }), ErrorCode::bad_input);
  EXPECT_EQ(code([](O&, P& p) { p.chart = 7; }), ErrorCode::bad_input);
  EXPECT_EQ(code([](O&, P& p) { p.texels_per_unit.y = 0; }), ErrorCode::bad_input);
  EXPECT_EQ(code([](O&, P& p) { p.page = -1; }), ErrorCode::bad_input);
  EXPECT_EQ(code([](O&, P& p) { p.cosine = p.sine = 0; }), ErrorCode::bad_input);
  EXPECT_EQ(code([](O&, P& p) { p.cosine = 5; }), ErrorCode::bad_input);
  EXPECT_EQ(code([](O&, P& p) { p.cosine = 1.00002; }), ErrorCode::bad_input);
  EXPECT_EQ(code([](O&, P& p) { p.cosine = 0.99999999; }), ErrorCode::ok);  // rounded to a float
  EXPECT_EQ(code([](O& o, P&) { o.shifts = 0; }), ErrorCode::bad_option);
  EXPECT_EQ(code([](O& o, P&) { o.shifts = 65; }), ErrorCode::bad_option);
  EXPECT_EQ(code([](O& o, P&) { o.shifts = 64; }), ErrorCode::ok);
  EXPECT_EQ(code([](O& o, P&) { o.mip_levels = 30; }), ErrorCode::bad_option);
  for (const int wrong : {0, -1, 65537}) {
    EXPECT_EQ(code([=](O& o, P&) { o.page_width = wrong; }), ErrorCode::bad_option);
    EXPECT_EQ(code([=](O& o, P&) { o.page_height = wrong; }), ErrorCode::bad_option);
  }
}

TEST(BakePage, RefusesPlacementsOfSeveralPagesAndChartsOfOtherScenes) {
  LitShape shape = make_sheet({1, 1, 2, 2}, [](double, double) { return shown(1); });
  append(shape, make_sheet({1, 1, 2, 2}, [](double, double) { return shown(1); }), {0, 0, 1});
  ChartPlacement first = place(shape.charts, 0, {5, 5}, {4, 4});
  ChartPlacement second = place(shape.charts, 1, {5, 5}, {16, 16});
  EXPECT_TRUE(bake(shape, {first, second}, small_page(32)).ok());
  second.page = 1;
  EXPECT_NE(bake(shape, {first, second}, small_page(32))
                .status()
                .message()
                .find("lies on page 0, and chart 1 on page 1"),
            std::string::npos);
  const LitShape other = make_sheet({1, 1, 2, 2}, [](double, double) { return shown(1); });
  const LuminanceSampler sampler(other.scene, Quantity::illuminance);
  const ChartLight mixed{sampler, shape.charts, kPlain};
  const std::vector<ChartPlacement> placements{first};
  EXPECT_EQ(bake_page(mixed, placements, small_page(32), {}).status().code(), ErrorCode::bad_input);
  EXPECT_EQ(size_chart_textures(mixed, {}, {}).status().message(),
            "the charts are of a mesh of 16 triangles, and the scene has 8");
  EXPECT_EQ(wanted_densities(mixed, {}, {}).status().code(), ErrorCode::bad_input);
  const ChartLight own{sampler, other.charts, kPlain};
  EXPECT_TRUE(wanted_densities(own, {}, {}).ok());
  EXPECT_EQ(wanted_densities(own, {.texel = 0}, {}).status().code(), ErrorCode::bad_option);
}

TEST(BakePage, RefusesChartsThatContradictThemselves) {
  const LitShape good = make_sheet({1, 1, 2, 2}, [](double, double) { return shown(1); });
  const ChartPlacement p = place(good.charts, 0, {20, 20}, {4, 4});
  const LuminanceSampler sampler(good.scene, Quantity::illuminance);
  for (const test::BrokenCharts& broken : test::broken_charts()) {
    LitShape shape = good;
    broken.damage(shape.charts);
    const ChartLight light{sampler, shape.charts, kPlain};
    EXPECT_EQ(bake(shape, {p}, small_page(32)).status().code(), ErrorCode::bad_input)
        << broken.what;
    EXPECT_EQ(size_chart_textures(light, {}, {}).status().code(), ErrorCode::bad_input)
        << broken.what;
    EXPECT_EQ(wanted_densities(light, {}, {}).status().code(), ErrorCode::bad_input) << broken.what;
  }
  // Vertices of uvs are not read.
  LitShape shape = good;
  shape.charts.uv_vertex.clear();
  EXPECT_TRUE(bake(shape, {p}, small_page(32)).ok());
}

// Charts show their light however little of a texel they cover. They were once black.
TEST(BakePage, ShowsTheLightOfChartsFarBelowATexel) {
  for (const BakeMethod method : {BakeMethod::least_squares, BakeMethod::average})
    for (const double density : {1e-2, 1e-5, 1e-20, 1e-200}) {
      const LitShape shape = make_sheet({1, 1, 3, 3}, [](double, double) { return shown(0.8); });
      const ChartPlacement p = place(shape.charts, 0, {density, density}, {4, 4});
      BakeOptions options = small_page(16, method);
      options.linear = true;
      const auto page = bake(shape, {p}, options);
      ASSERT_TRUE(page.ok());
      EXPECT_NEAR(page->display.at(4, 4)[1], 204, 1) << density;
      EXPECT_NEAR(page->linear.at(4, 4)[1], shown(0.8).y, 1e-4) << density;
    }
}

TEST(BakePage, RefusesPlacementsBeyondCounting) {
  const LitShape shape = make_sheet({1, 1, 2, 2}, [](double, double) { return shown(1); });
  const ChartPlacement good = place(shape.charts, 0, {20, 20}, {4, 4});
  for (const double bad : {1e6, 1e300, double(INFINITY)}) {
    ChartPlacement p = good;
    p.texels_per_unit = {bad, bad};
    EXPECT_EQ(bake(shape, {p}, small_page(32)).status().code(), ErrorCode::bad_input) << bad;
    p = good;
    p.offset.y = -bad;
    EXPECT_EQ(bake(shape, {p}, small_page(32)).status().code(), ErrorCode::bad_input) << bad;
  }
  ChartPlacement p = good;
  p.cosine = NAN;
  EXPECT_EQ(bake(shape, {p}, small_page(32)).status().code(), ErrorCode::bad_input);
}

TEST(BakePage, RefusesLightThatIsNotFinite) {
  for (const float bad : {NAN, INFINITY, -INFINITY}) {
    LitShape shape = make_sheet({1, 1, 9, 9}, [](double u, double) { return shown(u); });
    const ChartPlacement p = place(shape.charts, 0, {20, 20}, {4, 4});
    shape.scene.illumination[35].y = bad;
    const auto page = bake(shape, {p}, small_page(32));
    ASSERT_EQ(page.status().code(), ErrorCode::bad_input) << bad;
    EXPECT_NE(page.status().message().find("vertex 35 "), std::string::npos)
        << page.status().message();
    // Charts of other pages do not matter.
    EXPECT_TRUE(bake(shape, {}, small_page(32)).ok());
  }
}

TEST(BakePage, StopsWhenCancelled) {
  const LitShape shape = make_sheet({1, 1, 2, 2}, [](double, double) { return shown(1); });
  const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
  const std::atomic<bool> stop{true};
  Context context;
  context.cancel = &stop;
  const std::vector<ChartPlacement> p{place(shape.charts, 0, {20, 20}, {4, 4})};
  const auto page = bake_page({sampler, shape.charts, kPlain}, p, small_page(32), context);
  EXPECT_EQ(page.status().code(), ErrorCode::cancelled);
}

}  // namespace
}  // namespace atlas
