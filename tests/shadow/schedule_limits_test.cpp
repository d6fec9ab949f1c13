// The limits of the schedule's options, and lights that do not move as was predicted.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "libatlas/shadow/blend.h"
#include "libatlas/shadow/schedule.h"
#include "tests/shadow/fake_renderer.h"

namespace atlas {
namespace {

using test::circled;
using test::degrees_between;
using test::FakeRenderer;

// Returns the numbers of all plans for a light of one degree a frame.
std::vector<double> plans_of(const ScheduleOptions& options, bool scripted) {
  KeySchedule schedule(options);
  std::vector<double> all;
  for (int f = 0; f < 40; ++f) {
    const FramePlan plan = schedule.next(
        circled(f), scripted ? [f](int n) { return circled(f + n); } : KeySchedule::Ahead());
    all.insert(all.end(), {double(plan.from), double(plan.to), plan.t, double(plan.refreshed),
                           degrees_between(circled(0), plan.from_direction),
                           degrees_between(circled(0), plan.to_direction)});
    for (const MapWork& w : plan.work) all.insert(all.end(), {double(w.slot), w.begin, w.end});
  }
  return all;
}

TEST(Schedule, IntervalsOfLessThanOneFrameAreOneFrame) {
  for (const bool blend : {false, true})
    for (const bool scripted : {false, true})
      for (const int frames : {0, -1, -64}) {
        ScheduleOptions one, fewer;
        one.blend = fewer.blend = blend;
        one.interval_frames = 1;
        fewer.interval_frames = frames;
        EXPECT_EQ(plans_of(fewer, scripted), plans_of(one, scripted)) << blend << scripted;
        one.interval_degrees = fewer.interval_degrees = 4;
        one.max_frames = 1;
        fewer.max_frames = frames;
        EXPECT_EQ(plans_of(fewer, scripted), plans_of(one, scripted)) << blend << scripted;
      }
}

// Rounding must not add a frame to an interval whose degrees are a whole number of steps.
TEST(Schedule, KeysByDegreesComeAfterTheWholeNumberOfFrames) {
  for (const int frames : {4, 8, 20, 40}) {
    ScheduleOptions o;
    o.interval_degrees = 4;
    KeySchedule schedule(o);
    o.blend = false;
    KeySchedule held(o);
    FakeRenderer r;
    const double step = 4.0 / frames;
    for (int f = 0; f < 1000; ++f) {
      const FramePlan plan =
          schedule.next(circled(f * step), [&](int n) { return circled((f + n) * step); });
      r.run(plan);
      ASSERT_NEAR(plan.t, double(f % frames) / frames, 1e-12) << frames << " " << f;
      const bool drawn = !held.next(circled(f * step), nullptr).work.empty();
      ASSERT_EQ(drawn, f % frames == 0) << frames << " " << f;
    }
  }
}

// The smaller of both limits on degrees places the keys. Otherwise the blend would reach the place
// of rest long after the light.
TEST(Schedule, ALightThatRestsAtTheLargestDistanceIsFollowedThere) {
  ScheduleOptions o;
  o.interval_degrees = 30;
  o.max_key_degrees = 16;
  KeySchedule schedule(o);
  FakeRenderer r;
  const auto place = [](int f) { return std::min(2.0 * f, 16.0); };
  for (int f = 0; f < 100; ++f) {
    const FramePlan plan =
        schedule.next(circled(place(f)), [&](int n) { return circled(place(f + n)); });
    r.run(plan);
    const double shown = (1 - plan.t) * degrees_between(circled(0), plan.from_direction) +
                         plan.t * degrees_between(circled(0), plan.to_direction);
    EXPECT_NEAR(shown, place(f), 1e-6) << f;
  }
}

TEST(Schedule, AsksForNoMoreThanThreeIntervalsAhead) {
  for (const double step : {0.0, 0.1, 1.0, 30.0})
    for (const double degrees : {0.0, 3.0, 500.0})
      for (const int frames : {1, 2, 7}) {
        ScheduleOptions o;
        o.interval_degrees = degrees;
        o.interval_frames = degrees > 0 ? 1 : frames;  // each is as small as the other allows
        o.max_frames = degrees > 0 ? frames : 1;
        KeySchedule schedule(o);
        for (int f = 0; f < 40; ++f)
          schedule.next(circled(f * step), [&](int n) {
            EXPECT_GE(n, 0);
            EXPECT_LE(n, 3 * std::max(o.interval_frames, o.max_frames) + 1);
            return circled((f + n) * step);
          });
      }
}

// The key after the next one is being drawn already, so a start that comes a few frames early needs
// no map at once.
TEST(Schedule, AStartThatWasPredictedForALittleLaterDrawsNothingAtOnce) {
  KeySchedule schedule({});
  FakeRenderer r;
  const auto place = [](int f, int start) { return circled(std::max(0, f - start)); };
  for (int f = 0; f < 24; ++f) {
    const int start = f < 6 ? 10 : 5;
    const FramePlan plan =
        schedule.next(place(f, start), [&](int n) { return place(f + n, start); });
    r.run(plan);
    EXPECT_EQ(plan.refreshed, f == 0) << f;
  }
}

// A path that starts again jumps back to its start. Where frames vary in length, the jump may come
// later than was predicted, and the shadows of the start must not show before it.
TEST(Schedule, NoFrameShowsAKeyBeyondAJumpThatComesLate) {
  for (const double turn : {30.0, 60.0, 120.0})
    for (int predicted = 9; predicted <= 40; ++predicted)
      for (const int late : {0, 1, 2}) {
        KeySchedule schedule({});
        FakeRenderer r;
        for (int f = 0; f < 64; ++f) {
          const int jump = std::min(std::max(predicted, f + 1), predicted + late);
          const auto at = [&](int n) { return circled(f + n < jump ? f + n : f + n + turn); };
          const FramePlan plan = schedule.next(at(0), at);
          r.run(plan);
          EXPECT_LE(degrees_between(plan.from_direction, at(0)), 16)
              << turn << " at " << predicted << "+" << late << " " << f;
          if (plan.t > 0) {
            EXPECT_LE(degrees_between(plan.to_direction, at(0)), 16)
                << turn << " at " << predicted << "+" << late << " " << f;
          }
        }
      }
}

// Whether a light stops at a key or between two, the blend must not go on without it.
TEST(Schedule, ALightThatStopsInAnyFrameIsShownWhereItRests) {
  for (int stop = 1; stop <= 40; ++stop) {
    KeySchedule schedule({});
    FakeRenderer r;
    for (int f = 0; f < 64; ++f) {
      const Vec3d now = circled(std::min(f, stop));
      const FramePlan plan =
          schedule.next(now, [&](int n) { return f > stop ? now : circled(f + n); });
      r.run(plan);
      if (f <= stop) continue;
      EXPECT_LT(degrees_between(plan.from_direction, now), 1e-3) << stop << " " << f;
      if (plan.t > 0) {
        EXPECT_LT(degrees_between(plan.to_direction, now), 1e-3) << stop << " " << f;
      }
    }
  }
}

TEST(Schedule, AHeldMapIsRefreshedByAJump) {
  ScheduleOptions o;
  o.blend = false;
  for (const double jump : {19.0, 21.0, 150.0}) {
    KeySchedule schedule(o);
    FakeRenderer r;
    for (int f = 0; f < 24; ++f) {
      const Vec3d now = circled(f < 13 ? 0 : jump);
      const FramePlan plan = schedule.next(now, nullptr);
      r.run(plan);
      const bool jumped = f == 13 && jump > o.jump_degrees;
      EXPECT_EQ(plan.refreshed, f == 0 || jumped) << jump << " " << f;
      if (f == 0 || jumped) {
        EXPECT_EQ(plan.work.size(), 1u) << jump << " " << f;
        EXPECT_EQ(plan.from_direction, now) << jump << " " << f;
      }
    }
  }
}

// A held map is as bound to max_key_degrees as keys that are blended.
TEST(Schedule, AHeldMapIsNeverFurtherFromTheLightThanKeysMayBe) {
  for (const double most : {16.0, 90.0})
    for (const double by_degrees : {0.0, 200.0})
      for (const double step : {1.0, 5.0, 15.0}) {
        ScheduleOptions o;
        o.blend = false;
        o.interval_frames = o.max_frames = 32;
        o.interval_degrees = by_degrees;
        o.max_key_degrees = most;
        KeySchedule schedule(o);
        FakeRenderer r;
        for (int f = 0; f < 100; ++f) {
          const FramePlan plan = schedule.next(circled(f * step), nullptr);
          r.run(plan);
          EXPECT_LE(degrees_between(plan.from_direction, circled(f * step)), most + 1e-6) << step;
        }
        EXPECT_LE(r.begun, 1 + 99 / std::max(1, std::min(32, int(most / step)))) << step;
      }
}

}  // namespace
}  // namespace atlas
