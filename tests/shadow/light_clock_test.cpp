// The light of a window on fast and slow machines, with the schedule that the light drives.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "libatlas/shadow/blend.h"
#include "libatlas/shadow/light_clock.h"
#include "libatlas/shadow/schedule.h"
#include "tests/shadow/fake_renderer.h"

namespace atlas {
namespace {

using test::circled;
using test::kDegree;

struct Walk {
  int refreshes = 0, frames = 0;
  double furthest = 0;   // largest angle between the sampled keys, in degrees
  double most_work = 0;  // most maps drawn in a frame; frames with a refresh are left out
};

// Simulates a window with `fps` frames per second whose durations vary by `jitter` (a fraction).
Walk walk(double fps, double speed, double jitter) {
  ScheduleOptions options;
  options.max_key_degrees = 16;
  KeySchedule schedule(options);
  LightClock clock;
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> noise(1 - jitter, 1 + jitter);
  Walk w;
  for (; w.frames < 400; ++w.frames) {
    clock.advance(noise(rng) / fps, speed);
    const FramePlan plan =
        schedule.next(circled(clock.travelled()), [&](int n) { return circled(clock.ahead(n)); });
    w.refreshes += plan.refreshed;
    w.furthest =
        std::max(w.furthest, angle_between(plan.from_direction, plan.to_direction) / kDegree);
    double work = 0;
    for (const MapWork& m : plan.work) work += m.end - m.begin;
    if (!plan.refreshed) w.most_work = std::max(w.most_work, work);
  }
  return w;
}

TEST(LightClock, NoMachineIsSoSlowThatEveryFrameRefreshes) {
  for (double fps : {0.2, 1.0, 3.0, 10.0, 60.0, 500.0})
    for (double speed : {0.1, 15.0, 90.0, 1000.0})
      for (double jitter : {0.0, 0.6}) {
        const Walk w = walk(fps, speed, jitter);
        EXPECT_EQ(w.refreshes, 1) << fps << " fps, " << speed << " degrees a second";
        // Jitter changes the mean step, and with it the key after the next one.
        EXPECT_LE(w.furthest, 16 * (jitter > 0 ? 1.5 : 1.0 + 1e-6)) << fps << " " << speed;
        EXPECT_LE(w.most_work, 1.0 / 7) << fps << " " << speed;
      }
}

TEST(LightClock, FastMachinesKeepTheSpeedSlowOnesTheStep) {
  LightClock fast, slow;
  for (int f = 0; f < 600; ++f) fast.advance(1.0 / 60, 15);
  EXPECT_NEAR(fast.travelled(), 150, 1e-9);
  EXPECT_FALSE(fast.slowed());
  EXPECT_NEAR(fast.ahead(8) - fast.travelled(), 8 * 0.25, 1e-9);
  for (int f = 0; f < 10; ++f) slow.advance(3, 15);
  EXPECT_NEAR(slow.travelled(), 20, 1e-9);
  EXPECT_TRUE(slow.slowed());
  EXPECT_NEAR(slow.ahead(3) - slow.travelled(), 6, 1e-9);
}

TEST(LightClock, ARestingLightStaysAndNonsenseMovesNothing) {
  const double inf = std::numeric_limits<double>::infinity();
  LightClock clock({-1});
  clock.advance(0.1, 15);
  const double before = clock.travelled();
  for (double bad : {0.0, -5.0, std::numeric_limits<double>::quiet_NaN(), inf}) {
    clock.advance(0.1, bad);
    clock.advance(bad, 15);
    clock.advance(bad, bad);
    clock.advance(bad, 0);
    EXPECT_EQ(clock.travelled(), before) << bad;
    EXPECT_TRUE(std::isfinite(clock.ahead(1000))) << bad;
  }
  clock.advance(0.1, 15);
  EXPECT_NEAR(clock.travelled(), before + 1.5, 1e-9) << "a bad frame leaves no trace";
  clock.advance(0.1, 0);
  EXPECT_EQ(clock.ahead(50), clock.travelled());
  LightClock boundless({inf});
  boundless.advance(1e300, 1e300);
  EXPECT_TRUE(std::isfinite(boundless.travelled()));
}

// About the last twenty frames make up the mean: one slow frame must not send keys far ahead of the
// light, and a machine that has become slow must be noticed soon.
TEST(LightClock, ThePredictionForgetsOneSlowFrameAndLearnsLastingOnes) {
  const double speed = 15, usual = 0.01;
  const auto predicted = [&](int slow_frames, double slow) {
    LightClock clock;
    for (int f = 0; f < 500; ++f) clock.advance(usual, speed);
    for (int f = 0; f < slow_frames; ++f) clock.advance(slow * usual, speed);
    return (clock.ahead(1) - clock.travelled()) / (speed * usual);  // in usual steps
  };
  EXPECT_NEAR(predicted(0, 1), 1, 1e-9);
  EXPECT_GT(predicted(1, 10), 1);
  EXPECT_LT(predicted(1, 10), 2);
  EXPECT_LT(predicted(5, 2), 1.5) << "five frames are a small part of twenty";
  EXPECT_GT(predicted(20, 2), 1.5) << "twenty frames are most of the mean";
  EXPECT_NEAR(predicted(150, 2), 2, 0.01);
}

TEST(LightClock, TheLimitMayBeAnyPartOfADegree) {
  for (const double limit : {1e-6, 0.25, 1.0, 1.5}) {
    LightClock clock({limit});
    for (int f = 1; f <= 3; ++f) {
      clock.advance(1, 90);
      EXPECT_DOUBLE_EQ(clock.travelled(), f * limit);
    }
    EXPECT_DOUBLE_EQ(clock.ahead(2), 5 * limit);
  }
}

TEST(LightClock, AStepOfExactlyTheLimitIsNotSlowed) {
  LightClock clock({2});
  clock.advance(0.25, 8);
  EXPECT_EQ(clock.travelled(), 2);
  EXPECT_FALSE(clock.slowed());
  clock.advance(0.25, 8.5);
  EXPECT_EQ(clock.travelled(), 4);
  EXPECT_TRUE(clock.slowed());
  clock.advance(0.25, 4);
  EXPECT_FALSE(clock.slowed());
}

}  // namespace
}  // namespace atlas
