// What a search for layouts of outlines may spend: more of it never gives a worse layout, time is
// kept whatever is packed, and a cancelled search ends at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "libatlas/core/clock.h"
#include "libatlas/pack/fitting/fit_search.h"
#include "tests/pack/one_page.h"
#include "tests/support/layout_checks.h"
#include "tests/support/slowness.h"

namespace atlas {
namespace {

using pack::FitSearchOptions;

enum class Kind { blobs, bars, slivers };

test::ChartItems charts_of(Kind kind, int count, test::Noise& noise) {
  std::vector<std::vector<Vec2d>> shapes;
  for (int k = 0; k < count; ++k) {
    const double a = 20 + 80 * noise.unit(), b = 10 + 30 * noise.unit();
    if (kind == Kind::blobs) shapes.push_back(test::blob(noise, a, noise.in(4, 12)));
    if (kind == Kind::bars) shapes.push_back(test::box(a, b));
    if (kind == Kind::slivers) shapes.push_back({{0, 0}, {10 * a, b}, {10 * a, b + 3}});
  }
  return test::ChartItems(std::move(shapes));
}

struct Case {
  std::string name;
  Kind kind = Kind::blobs;
  int count = 12;
  FitSearchOptions options = {};
};

// One of each way to fit charts.
std::vector<Case> cases() {
  FitSearchOptions free, square, pages, straight, small, scaled, some;
  free.page_size = square.page_size = straight.page_size = scaled.page_size = some.page_size = 512;
  for (FitSearchOptions* o : {&free, &square, &pages, &straight, &small, &scaled, &some}) {
    o->padding = o->alignment = 1;
    o->minimum_side = 0;
    o->max_scale = 100;
    o->free_aspect = true;
  }
  square.free_aspect = pages.free_aspect = false;
  pages.page_size = 256;
  pages.pages = 3;
  straight.any_angle = false;
  small.page_size = 64;
  scaled.max_scale = 0.5;
  return {{"pressed", Kind::blobs, 12, free},        {"in rows", Kind::bars, 20, free},
          {"slivers", Kind::slivers, 12, free},      {"square", Kind::blobs, 12, square},
          {"square bars", Kind::bars, 20, square},   {"pages", Kind::blobs, 12, pages},
          {"few angles", Kind::blobs, 12, straight}, {"small page", Kind::blobs, 12, small},
          {"at a scale", Kind::blobs, 12, scaled},   {"cells", Kind::blobs, 150, some},
          {"many", Kind::blobs, 700, some}};
}

double goodness(const FitResult& fit, const FitOptions& options) {
  return options.free_aspect ? fit.utilization : fit.scale;
}

FitResult fitted(const test::ChartItems& charts, const FitSearchOptions& options,
                 const Context& context) {
  const Result<FitResult> fit = pack::search_fit(charts.items, options, context);
  EXPECT_TRUE(fit.ok()) << fit.status().message();
  if (!fit.ok()) return {};
  EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, *fit), fit->pages, options.padding),
            "");
  return *fit;
}

// Rounds take little work, so that there are many inputs.
TEST(Effort, MoreIsNeverWorse) {
  constexpr int kInputs = 3;
  test::Noise noise{4};
  for (const Case& c : cases()) {
    if (c.count > 100) continue;
    for (int input = 0; input < kInputs; ++input) {
      const test::ChartItems charts = charts_of(c.kind, noise.in(2, c.count), noise);
      FitSearchOptions o = c.options;
      o.shapes = charts.shapes;
      o.first_round = 0.02;
      double before = goodness(fitted(charts, o, {}), o);
      o.preset = PackPreset::best;
      for (const std::uint64_t effort : {1, 5, 20, 60}) {
        o.effort = effort;
        const double now = goodness(fitted(charts, o, {}), o);
        EXPECT_GE(now, before) << c.name << " " << input << " " << effort;
        before = now;
      }
    }
  }
}

// As many charts as the case says, to be packed by `best`.
struct ForBest {
  test::Noise noise{7};
  test::ChartItems charts;
  FitSearchOptions options;

  explicit ForBest(const Case& c) : charts(charts_of(c.kind, c.count, noise)), options(c.options) {
    options.shapes = charts.shapes;
    options.preset = PackPreset::best;
  }
};

TEST(TimeBudget, IsKeptWhateverIsPacked) {
  constexpr double kTooLong = 1.2, kBesides = 0.05;  // seconds
  Context one;
  one.threads = 1;
  for (const Case& c : cases()) {
    const ForBest problem(c);
    const test::ChartItems& charts = problem.charts;
    FitSearchOptions o = problem.options;
    o.preset = PackPreset::fast;
    const double begun_fast = cpu_seconds();
    fitted(charts, o, one);
    const double fast = cpu_seconds() - begun_fast;
    o.preset = PackPreset::best;
    for (const double budget : {0.1, 0.4}) {
      o.time_budget = budget;
      const double begun = cpu_seconds();
      const Result<FitResult> fit = pack::search_boxes_or_outlines(charts.items, o, one);
      EXPECT_TRUE(fit.ok());
      EXPECT_LE(cpu_seconds() - begun,
                kTooLong * std::max(budget, fast) + test::kSlowness * kBesides)
          << c.name;
    }
  }
}

TEST(CancelledFit, EndsAtOnce) {
  for (const Case& c : cases()) {
    const ForBest problem(c);
    FitSearchOptions o = problem.options;
    o.effort = 1'000'000;
    std::atomic<bool> raised{false};
    double at = 0;
    Context one;
    one.threads = 1;
    one.cancel = &raised;
    std::thread alarm([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(150));
      at = cpu_seconds();
      raised = true;
    });
    const Result<FitResult> fit = pack::search_boxes_or_outlines(problem.charts.items, o, one);
    const double ended = cpu_seconds();
    alarm.join();
    if (fit.ok()) continue;  // all charts are as large as they may be
    EXPECT_EQ(fit.status().code(), ErrorCode::cancelled) << c.name;
    EXPECT_LE(ended - at, test::kSlowness * 0.05) << c.name;
  }
}

}  // namespace
}  // namespace atlas
