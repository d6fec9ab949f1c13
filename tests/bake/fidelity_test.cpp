#include "libatlas/bake/fidelity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <random>
#include <utility>

#include "tests/bake/bake_fixture.h"

namespace atlas {
namespace {

struct Setup {
  LitShape shape;
  LuminanceSampler sampler;
  std::vector<ChartPlacement> placements;
  ChartLight light() const { return {sampler, shape.charts, kPlain}; }
};

// Two lit sheets on pages 0 and 1 and an unlit one on page 1, with areas 1, 1 and 2.
std::unique_ptr<Setup> two_pages() {
  LitShape shape =
      make_sheet({1, 1, 60, 60}, [](double u, double) { return shown(0.2 + 0.5 * u); });
  append(shape, make_sheet({1, 1, 60, 60}, [](double, double v) { return shown(0.1 + 0.8 * v); }),
         {0, 0, 1});
  append(shape, make_sheet({2, 1, 3, 3}, [](double, double) { return Vec3f{}; }), {0, 0, 2});
  LuminanceSampler sampler(shape.scene, Quantity::illuminance);
  auto s = std::unique_ptr<Setup>(new Setup{std::move(shape), std::move(sampler), {}});
  s->sampler = LuminanceSampler(s->shape.scene, Quantity::illuminance);
  s->placements = {place(s->shape.charts, 0, {100, 100}, {4, 4}),
                   place(s->shape.charts, 1, {100, 100}, {4, 4, true}),
                   place(s->shape.charts, 2, {8, 16}, {108, 4})};
  s->placements[1].page = s->placements[2].page = 1;
  return s;
}

std::vector<Image8> bake_pages(const Setup& s) {
  std::vector<Image8> pages;
  for (int page = 0; page < 2; ++page) {
    std::vector<ChartPlacement> own;
    for (const auto& p : s.placements)
      if (p.page == page) own.push_back(p);
    auto baked = bake_page(s.light(), own, small_page(128), Context{});
    EXPECT_TRUE(baked.ok());
    pages.push_back(baked->display);
  }
  return pages;
}

FidelityMeter meter_of(const ChartLight& light, std::span<const ChartPlacement> placements,
                       const FidelityOptions& options) {
  auto meter = FidelityMeter::make(light, placements, options, {});
  EXPECT_TRUE(meter.ok()) << meter.status().message();
  return std::move(*meter);
}

TEST(Fidelity, OfAPerfectBakeIsTheRoundingOfEightBits) {
  const auto s = two_pages();
  const std::vector<Image8> pages = bake_pages(*s);
  FidelityMeter meter = meter_of(s->light(), s->placements, {});
  meter.add_page(0, pages[0]);
  meter.add_page(1, pages[1]);
  const Fidelity f = meter.result();
  EXPECT_EQ(f.lit + f.unlit, 100000u);
  EXPECT_NEAR(static_cast<double>(f.unlit), 50000, 10);  // by area, because samples are stratified
  EXPECT_EQ(f.unplaced, 0u);
  EXPECT_GT(f.psnr, 56);  // rounding alone gives 58.9 dB
  EXPECT_LT(f.maximum, 1.2 / 255);
  EXPECT_GT(f.psnr_all, f.psnr);
  EXPECT_GT(f.rmse, 0);
  EXPECT_LT(f.rmse, 0.01);
}

TEST(Fidelity, MeasuresAKnownErrorExactly) {
  const auto s = two_pages();
  std::vector<Image8> pages = bake_pages(*s);
  // One channel is wrong by 20 codes everywhere, so its PSNR is -20 log10(20/255) within rounding.
  for (Image8& page : pages)
    for (std::size_t i = 1; i < page.texels.size(); i += 3)
      page.texels[i] = static_cast<std::uint8_t>(page.texels[i] + 20);
  FidelityMeter meter = meter_of(s->light(), s->placements, {});
  meter.add_page(1, pages[1]);
  meter.add_page(0, pages[0]);
  const Fidelity f = meter.result();
  EXPECT_NEAR(f.psnr_channel[1], -20 * std::log10(20.0 / 255), 0.05);
  EXPECT_GT(f.psnr_channel[0], 56);
  EXPECT_NEAR(f.psnr, f.psnr_channel[1] + 10 * std::log10(3.0), 0.05);
  EXPECT_NEAR(f.p95, 20 / 255.0, 0.004);
  EXPECT_NEAR(f.rmse_display, 20 / 255.0 / std::sqrt(3.0), 0.001);
}

// Texels that count up along both axes reproduce light that rises evenly, in look-ups at any place
// between four of them.
TEST(Fidelity, TellsWhereOnThePageTheErrorLies) {
  const auto s = two_pages();
  std::vector<Image8> pages = bake_pages(*s);
  for (int y = 0; y < 128; ++y)
    for (int x = 64; x < 128; ++x) pages[0].at(x, y)[1] += 20;
  FidelityMeter meter = meter_of(s->light(), s->placements, {});
  meter.add_page(0, pages[0]);
  meter.add_page(1, pages[1]);
  const FidelityMeter::Cells cells = meter.cells(0, 128, 128, 32);
  ASSERT_EQ(cells.columns, 4u);
  ASSERT_EQ(cells.rms.size(), 16u);
  for (std::size_t i = 0; i < 16; ++i) {
    if (i % 4 >= 2) {
      EXPECT_NEAR(cells.rms[i], 20 / 255.0 / std::sqrt(3), 0.004) << i;  // one channel of three
    } else {
      EXPECT_LT(cells.rms[i], 1.2 / 255) << i;
    }
  }
  EXPECT_EQ(meter.cells(1, 128, 128, 8).rms.back(), -1);  // no chart lies there
  EXPECT_EQ(meter.cells(0, 100, 70, 32).rms.size(), 12u);
}

// They are not rounded to 8 bits, and interpolated before the tone curve.
TEST(Fidelity, ReadsPagesOfLight) {
  const auto s = two_pages();
  FidelityMeter meter = meter_of(s->light(), s->placements, {});
  for (int page = 0; page < 2; ++page) {
    std::vector<ChartPlacement> own;
    for (const auto& p : s->placements)
      if (p.page == page) own.push_back(p);
    BakeOptions options = small_page(128);
    options.linear = true;
    const auto baked = bake_page(s->light(), own, options, Context{});
    ASSERT_TRUE(baked.ok());
    meter.add_light_page(page, baked->linear);
  }
  const Fidelity f = meter.result();
  EXPECT_EQ(f.unplaced, 0u);
  EXPECT_GT(f.psnr, 62);  // rounding to 8 bits alone gives 58.9 dB
}

TEST(Fidelity, LooksUpBetweenFourTexels) {
  const LitShape shape = make_sheet(
      {1, 1, 200, 200}, [](double u, double v) { return shown((20 + 50 * u + 100 * v) / 255); });
  const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
  const std::vector<ChartPlacement> placements{place(shape.charts, 0, {50, 50}, {4, 4})};
  const Vec2d corner = page_texel(placements[0], {0, 0});
  Image8 page(64, 64, 3);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      std::fill_n(
          page.at(x, y), 3,
          std::uint8_t(20 + std::lround(x + 0.5 - corner.x) + 2 * std::lround(y + 0.5 - corner.y)));
  // A corner between texels lies half a texel from their centres, by which the codes are rounded.
  const Vec2d rest{std::lround(0.5 - corner.x) - (0.5 - corner.x),
                   std::lround(0.5 - corner.y) - (0.5 - corner.y)};
  const double off = std::fabs(rest.x + 2 * rest.y) / 255;
  FidelityMeter meter = meter_of({sampler, shape.charts, kPlain}, placements, {});
  meter.add_page(0, page);
  const Fidelity f = meter.result();
  EXPECT_EQ(f.lit, 100000u);
  EXPECT_NEAR(f.maximum, off, 2e-4);
  EXPECT_NEAR(f.rmse_display, off, 1e-4);
}

// The error rises evenly from none at the lower edge to 100 codes at the upper one.
TEST(Fidelity, TellsWhichErrorsFewSamplesExceed) {
  const LitShape shape = make_sheet({1, 1, 1, 1}, [](double, double) { return shown(0.4); });
  const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
  const std::vector<ChartPlacement> placements{place(shape.charts, 0, {100, 100}, {4, 4})};
  const double bottom = page_texel(placements[0], {0, 0}).y;
  Image8 page(128, 128, 3);
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 128; ++x)
      std::fill_n(page.at(x, y), 3,
                  std::uint8_t(std::clamp(102 + std::lround(y + 0.5 - bottom), 0L, 255L)));
  FidelityMeter meter = meter_of({sampler, shape.charts, kPlain}, placements, {});
  meter.add_page(0, page);
  const Fidelity f = meter.result();
  constexpr double kHalfCode = 0.5 / 255 + 1e-4;  // texels are centred half a texel off the edge
  EXPECT_NEAR(f.p95, 95 / 255.0, kHalfCode);
  EXPECT_NEAR(f.p999, 99.9 / 255, kHalfCode);
  EXPECT_NEAR(f.p999 - f.p95, 4.9 / 255, 1e-4);
  EXPECT_NEAR(f.maximum - f.p999, 0.1 / 255, 1e-4);
}

// Pages show negative light black, so it has the error of light that is 0.
TEST(Fidelity, CountsNegativeLightAsNone) {
  const auto measured = [](double below) {
    LitShape shape = make_sheet({1, 1, 40, 40}, [&](double u, double) {
      const Vec3f light = shown(0.8 * u);
      return u < 0.5 ? Vec3f{float(below), float(below), float(below)} : light;
    });
    const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
    const ChartLight light{sampler, shape.charts, kPlain};
    const std::vector<ChartPlacement> placements{place(shape.charts, 0, {96, 96}, {4, 4})};
    FidelityMeter meter = meter_of(light, placements, {});
    Image8 page = bake_page(light, placements, small_page(128), Context{})->display;
    meter.add_page(0, page);
    return meter.result();
  };
  // Negative by so little that the step to the lit half lies where it does without.
  const Fidelity none = measured(0), negative = measured(-1e-6), far_below = measured(-1e3);
  EXPECT_NEAR(double(none.unlit), 100000 * 19.0 / 40, 20);
  EXPECT_NEAR(double(negative.unlit), double(none.unlit), 20);
  EXPECT_NEAR(negative.psnr, none.psnr, 0.3);
  EXPECT_NEAR(negative.rmse, none.rmse, 0.1 * none.rmse);
  // The column that rises from the negative half is lit at its very end only.
  EXPECT_NEAR(double(far_below.unlit), 50000, 100);
  EXPECT_LT(far_below.rmse, 1);
}

// An error in the corner of two large triangles counts in proportion to its area, because samples
// are even within a triangle and not only over the mesh.
TEST(Fidelity, WeighsAPartOfATriangleByItsArea) {
  LitShape shape = make_sheet({1, 1, 1, 1}, [](double, double) { return shown(0.5); });
  const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
  const ChartLight light{sampler, shape.charts, kPlain};
  const std::vector<ChartPlacement> placements{place(shape.charts, 0, {96, 96}, {4, 4})};
  const auto baked = bake_page(light, placements, small_page(128), Context{});
  ASSERT_TRUE(baked.ok());
  const auto square_error = [&](auto inside) {
    Image8 page = baked->display;
    for (int y = 0; y < 128; ++y)
      for (int x = 0; x < 128; ++x)
        if (inside(x - 4, y - 4))
          for (int k = 0; k < 3; ++k)
            page.at(x, y)[k] = static_cast<std::uint8_t>(page.at(x, y)[k] + 50);
    FidelityMeter meter = meter_of(light, placements, {});
    meter.add_page(0, page);
    const double rmse = meter.result().rmse_display;
    return rmse * rmse;
  };
  const double whole = square_error([](int, int) { return true; });
  for (const int side : {24, 48}) {
    const double share = side * side / (96.0 * 96.0);
    for (int corner = 0; corner < 4; ++corner) {
      const double part = square_error([&](int x, int y) {
        if (corner & 1) x = 95 - x;
        if (corner & 2) y = 95 - y;
        return x < side && y < side;
      });
      // The look-ups blur the border of the square, which changes about a fiftieth.
      EXPECT_NEAR(part / whole, share, 0.03 * share + 0.002) << side << ' ' << corner;
    }
  }
}

TEST(Fidelity, DoesNotDependOnTheOrderOfPagesAndRepeats) {
  const auto s = two_pages();
  const std::vector<Image8> pages = bake_pages(*s);
  const auto measure = [&](std::uint64_t seed, bool backwards) {
    FidelityMeter meter = meter_of(s->light(), s->placements, {20000, seed});
    for (int i = 0; i < 2; ++i) meter.add_page(backwards ? 1 - i : i, pages[backwards ? 1 - i : i]);
    return meter.result();
  };
  EXPECT_EQ(measure(1, false).psnr, measure(1, true).psnr);
  EXPECT_EQ(measure(1, false).p999, measure(1, true).p999);
  EXPECT_NE(measure(1, false).psnr, measure(2, false).psnr);
  EXPECT_NEAR(measure(1, false).psnr, measure(2, false).psnr, 0.2);
}

TEST(Fidelity, CountsWhatHasNoPage) {
  const auto s = two_pages();
  const std::vector<Image8> pages = bake_pages(*s);
  s->placements.pop_back();
  FidelityMeter meter = meter_of(s->light(), s->placements, {});
  meter.add_page(0, pages[0]);
  Image8 cut_short = pages[1];
  cut_short.texels.pop_back();
  meter.add_page(1, cut_short);
  meter.add_page(1, {});  // page 1 never comes
  const Fidelity f = meter.result();
  EXPECT_NEAR(static_cast<double>(f.lit), 25000, 10);
  EXPECT_NEAR(static_cast<double>(f.unplaced), 75000, 20);
  EXPECT_EQ(f.unlit, 0u);
  EXPECT_GT(f.psnr, 56);
}

TEST(Fidelity, RefusesPlacementsOfChartsThatAreNotThere) {
  const auto s = two_pages();
  s->placements[1].chart = 3;
  const auto meter = FidelityMeter::make(s->light(), s->placements, {}, {});
  ASSERT_EQ(meter.status().code(), ErrorCode::bad_input);
  EXPECT_EQ(meter.status().message(), "placement 1 names chart 3, but there are 3");
}

TEST(Fidelity, StopsWhenCancelled) {
  const auto s = two_pages();
  const std::atomic<bool> stop{true};
  Context context;
  context.cancel = &stop;
  EXPECT_EQ(FidelityMeter::make(s->light(), s->placements, {}, context).status().code(),
            ErrorCode::cancelled);
}

TEST(Fidelity, IsTheSameForEveryNumberOfThreads) {
  const auto s = two_pages();
  const std::vector<Image8> pages = bake_pages(*s);
  Fidelity found[2];
  for (const int threads : {1, 4}) {
    Context context;
    context.threads = threads;
    auto meter = FidelityMeter::make(s->light(), s->placements, {}, context);
    ASSERT_TRUE(meter.ok());
    for (int i = 0; i < 2; ++i) meter->add_page(i, pages[i]);
    found[threads > 1] = meter->result();
  }
  EXPECT_EQ(found[0].rmse, found[1].rmse);
  EXPECT_EQ(found[0].psnr, found[1].psnr);
  EXPECT_EQ(found[0].psnr_all, found[1].psnr_all);
  EXPECT_EQ(found[0].maximum, found[1].maximum);
}

TEST(Fidelity, LeavesClippedSamplesOutOfTheSceneUnits) {
  auto s = two_pages();
  for (Vec3f& e : s->shape.scene.illumination) e = {e.x * 4, e.y * 4, e.z * 4};
  const std::vector<Image8> pages = bake_pages(*s);
  FidelityMeter meter = meter_of(s->light(), s->placements, {});
  for (int i = 0; i < 2; ++i) meter.add_page(i, pages[i]);
  const Fidelity f = meter.result();
  EXPECT_GT(f.clipped, 1000u);
  EXPECT_LT(f.clipped, f.lit);
  EXPECT_LT(f.rmse, 0.02);  // clipping would show as tenths
  EXPECT_GT(f.psnr, 45);
}

TEST(Fidelity, AnyChannelBeyondWhiteIsClipped) {
  for (int channel = 0; channel < 3; ++channel) {
    const LitShape shape = make_sheet({1, 1, 1, 1}, [channel](double, double) {
      Vec3f light{0.3f, 0.3f, 0.3f};
      (channel == 0 ? light.x : channel == 1 ? light.y : light.z) = 2;
      return light;
    });
    const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
    const ChartLight light{sampler, shape.charts, kPlain};
    const std::vector<ChartPlacement> placements{place(shape.charts, 0, {20, 20}, {4, 4})};
    FidelityMeter meter = meter_of(light, placements, {});
    meter.add_page(0, bake_page(light, placements, small_page(32), Context{})->display);
    const Fidelity f = meter.result();
    EXPECT_EQ(f.lit, 100000u) << channel;
    EXPECT_EQ(f.clipped, f.lit) << channel;
    EXPECT_EQ(f.rmse, 0) << channel;
  }
}

TEST(Fidelity, PagesThatAreNotColourImagesCountAsNone) {
  const auto s = two_pages();
  FidelityMeter meter = meter_of(s->light(), s->placements, {});
  Image8 cut = bake_pages(*s)[0];
  cut.texels.pop_back();
  for (const Image8& page : {Image8(), Image8(128, 128, 1), Image8(128, 128, 2), cut}) {
    meter.add_page(0, page);
    EXPECT_EQ(meter.result().unplaced, 100000u - meter.result().unlit - meter.result().lit);
    EXPECT_EQ(meter.result().lit + meter.result().unlit, 0u);
  }
}

TEST(Fidelity, OfNothingIsNothing) {
  LitShape shape = make_sheet({1, 1, 1, 1}, [](double, double) { return shown(1); });
  for (Vec3f& p : shape.scene.positions) p = {};
  const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
  const ChartLight light{sampler, shape.charts, kPlain};
  const FidelityMeter meter = meter_of(light, {}, {});
  const Fidelity f = meter.result();
  EXPECT_EQ(f.lit + f.unlit + f.unplaced, 0u);
  EXPECT_EQ(f.psnr, 0);
}

}  // namespace
}  // namespace atlas
