// Cancels packing by outlines from another thread at any moment.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <string_view>
#include <thread>
#include <vector>

#include "libatlas/pack/fit.h"
#include "tests/pack/one_page.h"
#include "tests/support/layout_checks.h"

namespace atlas {
namespace {

using Seconds = std::chrono::duration<double>;

// Sets its flag after the given time, unless the work has ended by then.
class Alarm {
 public:
  explicit Alarm(Seconds after)
      : thread_([this, until = std::chrono::steady_clock::now() + after] {
          while (!ended_ && std::chrono::steady_clock::now() < until)
            std::this_thread::sleep_for(Seconds(1e-4));
          raised_ = true;
        }) {}
  ~Alarm() {
    ended_ = true;
    thread_.join();
  }

  const std::atomic<bool>* flag() const { return &raised_; }

 private:
  std::atomic<bool> raised_{false}, ended_{false};
  std::thread thread_;
};

double seconds_of(const test::ChartItems& charts, const FitOptions& options) {
  const auto begun = std::chrono::steady_clock::now();
  EXPECT_TRUE(fit_pages(charts.items, options, {}).ok());
  return Seconds(std::chrono::steady_clock::now() - begun).count();
}

// A loop that is cut short leaves pieces undrawn and pages unfilled; none of them may be read.
void cancel_at_any_time(const test::ChartItems& charts, const FitOptions& options) {
  constexpr int kMoments = 20;
  const double whole = seconds_of(charts, options);
  for (int k = 0; k < kMoments; ++k) {
    const Alarm alarm(Seconds(whole * k / kMoments));
    Context context;
    context.threads = 2;
    context.cancel = alarm.flag();
    const Result<FitResult> fit = fit_pages(charts.items, options, context);
    if (fit.ok())  // it was faster than the first time
      EXPECT_EQ(
          test::check_outlines(test::placed_shapes(charts, *fit), fit->pages, options.padding), "");
    else
      EXPECT_EQ(fit.status().code(), ErrorCode::cancelled);
  }
}

test::ChartItems blobs(int count, int largest) {
  test::Noise noise{9};
  std::vector<std::vector<Vec2d>> shapes;
  for (int k = 0; k < count; ++k) {
    const int corners = noise.in(5, 12), radius = noise.in(10, largest);
    shapes.push_back(test::blob(noise, radius, corners));
  }
  return test::ChartItems(std::move(shapes));
}

TEST(CancelledFit, OfSeveralPages) {
  const test::ChartItems charts = blobs(24, 50);
  FitOptions o = test::options_for(charts, 128);
  o.free_aspect = false;
  o.pages = 3;
  o.press_pages = false;
  cancel_at_any_time(charts, o);
}

// What was found before the cancellation must not be returned as if it were the result.
TEST(CancelledFit, InARoundOfBest) {
  const test::ChartItems charts = blobs(12, 90);
  FitOptions o = test::options_for(charts, 256);
  o.preset = PackPreset::best;
  o.effort = 100'000;
  std::atomic<bool> raised{false};
  Context context;
  context.cancel = &raised;
  context.progress = [&](std::string_view, double) { raised = true; };
  EXPECT_EQ(fit_pages(charts.items, o, context).status().code(), ErrorCode::cancelled);
}

TEST(CancelledFit, TheAreaCoveredIsNoPart) {
  const test::ChartItems charts = blobs(4, 30);
  const std::atomic<bool> raised{true};
  Context context;
  context.cancel = &raised;
  EXPECT_EQ(covered_area(charts.shapes, context).status().code(), ErrorCode::cancelled);
}

}  // namespace
}  // namespace atlas
