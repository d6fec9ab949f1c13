#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "libatlas/shadow/blend.h"
#include "libatlas/shadow/light_path.h"
#include "libatlas/shadow/schedule.h"
#include "tests/shadow/fake_renderer.h"

namespace atlas {
namespace {

using test::FakeRenderer;
using test::kDegree;
using test::turned;

TEST(Schedule, KeysAreExactAndWorkIsEven) {
  for (int k : {1, 2, 3, 8, 32}) {
    ScheduleOptions o;
    o.interval_frames = k;
    KeySchedule schedule(o);
    FakeRenderer r;
    for (int f = 0; f < 10 * k; ++f) {
      const FramePlan plan =
          schedule.next(turned(f * 0.5), [&](int n) { return turned((f + n) * 0.5); });
      r.run(plan);
      if (f == 0) r.most = r.work = 0;  // the first frame draws two maps at once, and reports this
      EXPECT_EQ(plan.refreshed, f == 0);
      EXPECT_LT(angle_between(plan.from_direction, turned(f / k * k * 0.5)), 1e-9);
      EXPECT_LT(angle_between(plan.to_direction, turned((f / k + 1) * k * 0.5)), 1e-9);
      EXPECT_NEAR(plan.t, double(f % k) / k, 1e-12);
    }
    // Every frame draws exactly 1/k of a map.
    EXPECT_NEAR(r.most, 1.0 / k, 1e-12);
    EXPECT_NEAR(r.work, (10 * k - 1) * 1.0 / k, 1e-9);
    EXPECT_EQ(schedule.passes(), r.begun);
  }
}

TEST(Schedule, AStaticLightDrawsExactlyOneMap) {
  for (bool blend : {false, true})
    for (bool scripted : {false, true})
      for (double degrees : {0.0, 4.0}) {
        ScheduleOptions o;
        o.blend = blend;
        o.interval_degrees = degrees;
        KeySchedule schedule(o);
        FakeRenderer r;
        for (int f = 0; f < 600; ++f)
          r.run(schedule.next(
              {1, 2, 3}, scripted ? [](int) { return Vec3d{1, 2, 3}; } : KeySchedule::Ahead()));
        EXPECT_EQ(r.begun, 1);
        EXPECT_EQ(schedule.passes(), 1);
      }
}

TEST(Schedule, NonsenseLimitsAreTheWidest) {
  const auto frames_of = [](double most) {
    ScheduleOptions o;
    o.max_key_degrees = most;
    KeySchedule schedule(o);
    std::vector<double> t;
    for (int f = 0; f < 60; ++f)
      t.push_back(schedule.next(turned(f * 15), [&](int n) { return turned((f + n) * 15); }).t);
    return t;
  };
  const std::vector<double> widest = frames_of(kMaxKeyDegrees);
  for (const double most : {0.0, -5.0, 1e9, std::nan("")}) EXPECT_EQ(frames_of(most), widest);
  EXPECT_NE(frames_of(16), widest);
}

TEST(Schedule, AJumpRefreshesAtOnce) {
  ScheduleOptions o;
  KeySchedule schedule(o);
  FakeRenderer r;
  const auto at = [](int f) { return turned(f < 50 ? f * 0.5 : 90 + f * 0.5); };
  for (int f = 0; f < 100; ++f) {
    const FramePlan plan = schedule.next(at(f), [&](int n) { return at(f + n); });
    r.run(plan);
    EXPECT_EQ(plan.refreshed, f == 0 || f == 50) << f;
    // No frame mixes keys from both sides of the jump.
    const double low = f < 50 ? 0 : 115, high = f < 50 ? 24.6 : 150;
    if (plan.t > 0)
      for (const Vec3d& d : {plan.from_direction, plan.to_direction}) {
        const double degrees = std::atan2(d.y, d.x) / kDegree;
        EXPECT_TRUE(degrees > low - 1e-6 && degrees < high) << f << " " << degrees;
      }
  }
}

TEST(Schedule, ALightThatJumpsInEveryFrameCostsOneMapAFrame) {
  KeySchedule schedule({});
  FakeRenderer r;
  for (int f = 0; f < 40; ++f)
    r.run(schedule.next(turned(f * 40), [&](int n) { return turned((f + n) * 40); }));
  EXPECT_LE(r.begun, 80);
  EXPECT_LE(r.work, 40 * 1.2);
}

TEST(Schedule, ChangeOfTheSceneRefreshesAtOnce) {
  KeySchedule schedule({});
  FakeRenderer r;
  for (int f = 0; f < 30; ++f) {
    if (f == 13) schedule.invalidate();
    const FramePlan plan = schedule.next(turned(f), [&](int n) { return turned(f + n); });
    r.run(plan);
    EXPECT_EQ(plan.refreshed, f == 0 || f == 13);
  }
}

TEST(Schedule, KeysByDegrees) {
  ScheduleOptions o;
  o.interval_degrees = 4;
  KeySchedule schedule(o);
  FakeRenderer r;
  for (int f = 0; f < 200; ++f) {
    const FramePlan plan =
        schedule.next(turned(f * 0.5), [&](int n) { return turned((f + n) * 0.5); });
    r.run(plan);
    const double apart = angle_between(plan.from_direction, plan.to_direction) / kDegree;
    EXPECT_NEAR(apart, 4, 0.5);
  }
}

// Under a slow light, no map is kept for ever: max_frames applies to held maps, too.
TEST(Schedule, HeldKeysByDegreesAreAtMostSoManyFramesOld) {
  ScheduleOptions o;
  o.blend = false;
  o.interval_degrees = 3.5;
  o.max_frames = 10;
  for (const double speed : {0.1, 1.0}) {
    KeySchedule schedule(o);
    for (int f = 0; f < 100; ++f) {
      const bool drawn = !schedule.next(turned(f * speed), {}).work.empty();
      EXPECT_EQ(drawn, f % (speed < 0.5 ? 10 : 4) == 0) << speed << " " << f;
    }
  }
}

TEST(Schedule, KeysAreNeverMoreThanNinetyDegreesApart) {
  ScheduleOptions o;
  o.interval_frames = 32;
  KeySchedule schedule(o);
  FakeRenderer r;
  for (int f = 0; f < 300; ++f) {
    const FramePlan plan =
        schedule.next(turned(f * 15), [&](int n) { return turned((f + n) * 15); });
    r.run(plan);
    EXPECT_LE(angle_between(plan.from_direction, plan.to_direction), 90.001 * kDegree);
  }
}

TEST(Schedule, AFastLightShortensTheIntervalInsteadOfStretchingIt) {
  for (double step : {0.5, 2.0, 3.0, 5.0, 15.0, 19.0}) {
    ScheduleOptions o;
    o.max_key_degrees = 16;
    KeySchedule schedule(o);
    FakeRenderer r;
    for (int f = 0; f < 200; ++f) {
      const FramePlan plan =
          schedule.next(turned(f * step), [&](int n) { return turned((f + n) * step); });
      r.run(plan);
      EXPECT_EQ(plan.refreshed, f == 0);
      EXPECT_LE(angle_between(plan.from_direction, plan.to_direction) / kDegree,
                std::max(16.0, step) + 1e-6);
      if (f == 0) r.most = 0;
    }
    const double frames = std::max(1.0, std::min(8.0, std::floor(16 / step)));
    EXPECT_NEAR(r.most, 1 / frames, 1e-9) << step;
  }
}

// A light that is moved quickly by hand, but never jumps in one frame: keys are drawn anew before
// they are further from the light than allowed.
TEST(Schedule, AHandThatRunsAwayFromTheKeysRefreshesThem) {
  ScheduleOptions o;
  o.max_key_degrees = 16;
  KeySchedule schedule(o);
  FakeRenderer r;
  int refreshes = 0;
  for (int f = 0; f < 90; ++f) {
    const Vec3d now = turned(f * 3.0);
    const FramePlan plan = schedule.next(now, nullptr);
    r.run(plan);
    refreshes += plan.refreshed;
    EXPECT_LE(angle_between(plan.from_direction, now) / kDegree, 16 + 1e-6);
  }
  EXPECT_LE(refreshes, 1 + 90 / 6);
  EXPECT_GT(refreshes, 1);
}

// A light on a path whose speed is changed by hand: at rest, moving, at rest, slow, ten times as
// fast.
TEST(Schedule, AScriptedLightThatStopsStartsOrHurriesStaysNearItsKeys) {
  ScheduleOptions options;
  options.max_key_degrees = 16;
  KeySchedule schedule(options);
  FakeRenderer renderer;
  double at = 0;
  for (int f = 0; f < 200; ++f) {
    const double speed = f < 21 ? 0 : f < 66 ? 1.9 : f < 110 ? 0 : f < 143 ? 0.2 : 2;
    at += speed;
    const FramePlan plan = schedule.next(turned(at), [&](int n) { return turned(at + n * speed); });
    renderer.run(plan);
    const auto off = [&](const Vec3d& key) { return angle_between(key, turned(at)) / kDegree; };
    EXPECT_LE(angle_between(plan.from_direction, plan.to_direction) / kDegree, 16.1) << f;
    EXPECT_LE(off(plan.from_direction), 24) << f;
    if ((f > 2 && f < 21) || (f > 67 && f < 110)) {
      EXPECT_LT(off(plan.from_direction), 1e-3) << "a light at rest has its own map, frame " << f;
      EXPECT_TRUE(plan.work.empty()) << f;
    }
    if (f >= 21 && f < 66) {
      EXPECT_LE(off(plan.from_direction), 16) << "a light that starts has keys at once, " << f;
    }
  }
}

// A light that is moved by hand: blended shadows arrive after two intervals at most, and one map is
// enough when the light rests.
TEST(Schedule, AHandMovedLightArrivesWithTheStatedDelay) {
  ScheduleOptions o;
  KeySchedule schedule(o);
  FakeRenderer r;
  for (int f = 0; f < 100; ++f) {
    const Vec3d d = turned(f < 20 ? 0 : f < 60 ? (f - 20) * 0.5 : 20);
    const FramePlan plan = schedule.next(d, nullptr);
    r.run(plan);
    const double shown = (1 - plan.t) * std::atan2(plan.from_direction.y, plan.from_direction.x) +
                         plan.t * std::atan2(plan.to_direction.y, plan.to_direction.x);
    const double late = std::atan2(d.y, d.x) - shown;
    EXPECT_GE(late, -1e-9);
    EXPECT_LE(late, (2 * o.interval_frames + 1) * 0.5 * kDegree);
    if (f > 80) {
      EXPECT_NEAR(late, 0, 1e-9);
    }
  }
}

TEST(Schedule, HoldDrawsAWholeMapEveryKFrames) {
  ScheduleOptions o;
  o.blend = false;
  o.interval_frames = 8;
  KeySchedule schedule(o);
  FakeRenderer r;
  for (int f = 0; f < 80; ++f) {
    const FramePlan plan = schedule.next(turned(f * 0.5), nullptr);
    r.run(plan);
    EXPECT_EQ(plan.work.size(), f % 8 == 0 ? 1u : 0u);
    EXPECT_EQ(plan.from, plan.to);
  }
  EXPECT_EQ(r.begun, 10);
  EXPECT_EQ(r.most, 1);
}

TEST(Schedule, SunPathOverADayKeepsAllRules) {
  const LightPath sun = *LightPath::make({});
  ScheduleOptions o;
  KeySchedule schedule(o);
  FakeRenderer r;
  int refreshes = 0;
  for (int f = 0; f < 2000; ++f) {
    const auto at = [&](int n) { return sun.direction((f + n) * 0.5); };
    const FramePlan plan = schedule.next(at(0), at);
    r.run(plan);
    refreshes += plan.refreshed;
  }
  EXPECT_EQ(refreshes, 1 + int(2000 * 0.5 / sun.length() + 0.3));
}

}  // namespace
}  // namespace atlas
