// Keys where a light's path turns back, has a corner, or ends.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "libatlas/shadow/blend.h"
#include "libatlas/shadow/light_clock.h"
#include "libatlas/shadow/light_path.h"
#include "libatlas/shadow/schedule.h"
#include "tests/shadow/fake_renderer.h"

namespace atlas {
namespace {

using test::circled;
using test::degrees_between;
using test::FakeRenderer;
using test::kDegree;

// Returns the direction that a blend of two keys stands for.
Vec3d shown_by(const FramePlan& plan) {
  const auto& [a, b] = std::pair(plan.from_direction, plan.to_direction);
  const double la = std::hypot(a.x, a.y, a.z), lb = std::hypot(b.x, b.y, b.z);
  const BlendWeights w =
      blend_weights(KeyBlend::slerp_raw, plan.from == plan.to ? 0 : plan.t, angle_between(a, b));
  return {w.from * a.x / la + w.to * b.x / lb, w.from * a.y / la + w.to * b.y / lb,
          w.from * a.z / la + w.to * b.z / lb};
}

struct Ride {
  double farthest = 0;  // degrees between the light and what the keys show of it
  double most = 0;      // part of a map that a frame drew, after the first one
  int begun = 0, refreshes = 0;
};

Ride ride(const LightPath& path, double start, double step, const ScheduleOptions& options) {
  KeySchedule schedule(options);
  FakeRenderer r;
  Ride ride;
  for (int f = 0; f < 150; ++f) {
    const auto at = [&](int n) { return path.direction(start + (f + n) * step); };
    const FramePlan plan = schedule.next(at(0), at);
    r.run(plan);
    if (f == 0) r.most = 0;
    ride.farthest = std::max(ride.farthest, degrees_between(shown_by(plan), at(0)));
    ride.refreshes += plan.refreshed;
  }
  ride.most = r.most;
  ride.begun = r.begun;
  return ride;
}

LightPath path_of(PathKind kind, PathEnd end, std::vector<Vec3d> directions) {
  return *LightPath::make({kind, end, std::move(directions), {}});
}

// A light tells a direction; the length of the vector is nothing. The path has corners, turns back
// and rests.
TEST(ScheduleTurns, TheLengthOfDirectionsDoesNotMatter) {
  const LightPath path = path_of(PathKind::keys, PathEnd::back,
                                 {circled(0), circled(40), {0.5, 0.5, 1}, {-1, 0.2, 0.7}});
  const auto at = [&](int frame) { return path.direction(0.75 * std::max(0, frame - 30)); };
  const auto stretched = [&](int frame) {
    const Vec3d d = at(frame);
    const double length = std::exp2(frame * 7 % 40 - 20);
    return Vec3d{d.x * length, d.y * length, d.z * length};
  };
  for (const double by_degrees : {0.0, 5.0}) {
    ScheduleOptions o;
    o.interval_degrees = by_degrees;
    KeySchedule plain(o), other(o);
    for (int f = 0; f < 400; ++f) {
      const FramePlan a = plain.next(at(f), [&](int n) { return at(f + n); });
      const FramePlan b = other.next(stretched(f), [&](int n) { return stretched(f + n); });
      ASSERT_EQ(a.t, b.t) << f;
      ASSERT_EQ(a.refreshed, b.refreshed) << f;
      ASSERT_EQ(a.work.size(), b.work.size()) << f;
      ASSERT_LT(degrees_between(a.to_direction, b.to_direction), 1e-5) << f;
    }
    EXPECT_EQ(plain.passes(), other.passes());
  }
}

// Wherever between two frames the light turns back, the shadows go along to within a step.
TEST(ScheduleTurns, ALightThatTurnsBackIsFollowedToTheTurn) {
  const LightPath path = path_of(PathKind::arc, PathEnd::back, {circled(0), circled(37)});
  for (const double by_degrees : {0.0, 4.0})
    for (const double step : {0.25, 0.5, 1.0, 2.0})
      for (double start = 20; start < 23; start += 0.1) {
        ScheduleOptions o;
        o.interval_degrees = by_degrees;
        const Ride shown = ride(path, start, step, o);
        EXPECT_LE(shown.farthest, 0.9 * step) << start << " by " << step;
        EXPECT_EQ(shown.refreshes, 1) << start << " by " << step;
        const double frames = by_degrees > 0 ? std::min(8.0, by_degrees / step) : 8;
        EXPECT_LE(shown.most, std::min(1.0, 2 / frames) + 1e-9)
            << "a short interval before a turn is shared";
      }
}

TEST(ScheduleTurns, CornersAreShown) {
  for (const double corner : {32.0, 60.0, 90.0, 120.0, 150.0}) {
    const double a = (180 - corner) * kDegree;
    const Vec3d side{std::cos(30 * kDegree), -std::sin(30 * kDegree) * std::cos(a),
                     std::sin(30 * kDegree) * std::sin(a)};
    const LightPath path = path_of(PathKind::keys, PathEnd::stop, {circled(-40), circled(0), side});
    for (double start = 0; start < 8; start += 0.13) {
      const Ride shown = ride(path, start, 1, {});
      EXPECT_LE(shown.farthest, 0.9) << corner << " from " << start;
      EXPECT_LE(shown.most, 0.25 + 1e-9) << corner << " from " << start;
    }
  }
}

TEST(ScheduleTurns, ALightThatStopsIsFollowedToItsPlaceOfRest) {
  const LightPath path = path_of(PathKind::arc, PathEnd::stop, {circled(0), circled(45)});
  for (double start = 0; start < 8; start += 0.13) {
    const Ride shown = ride(path, start, 1, {});
    EXPECT_LE(shown.farthest, 1) << start;
    EXPECT_LE(shown.most, 0.25 + 1e-9) << "no map is drawn at once where the light stops";
    EXPECT_EQ(shown.refreshes, 1) << start;
  }
}

// A path so short that its light goes back to the start by less than a jump. Both ends have keys.
TEST(ScheduleTurns, TheStartOfAShortPathIsNotBlendedWithItsEnd) {
  const LightPath path = path_of(PathKind::arc, PathEnd::loop, {circled(0), circled(15)});
  for (double start = 0; start < 8; start += 0.13)
    EXPECT_LE(ride(path, start, 0.5, {}).farthest, 0.5) << start;
}

// Corners that are no sharper than those of a curve drawn by points cost no keys.
TEST(ScheduleTurns, ACurveGivenByManyDirectionsHasEvenIntervals) {
  std::vector<Vec3d> circle;
  for (int i = 0; i < 60; ++i) {
    const double a = i * 10 * kDegree;
    circle.push_back({0.3 * std::cos(a), 0.3 * std::sin(a), 1});
  }
  const LightPath path = path_of(PathKind::keys, PathEnd::stop, circle);
  for (double start = 0; start < 3; start += 0.13) {
    const Ride shown = ride(path, start, 0.7, {});
    EXPECT_EQ(shown.begun, 21) << start;
    EXPECT_NEAR(shown.most, 0.125, 1e-9) << start;
  }
}

// Frames of a window vary in length, so a turn comes a little earlier or later than was predicted.
// The shadows follow it, and no frame draws a whole map for that.
TEST(ScheduleTurns, ATurnMayComeEarlierOrLaterThanPredicted) {
  const LightPath path = path_of(PathKind::arc, PathEnd::back, {circled(0), circled(30)});
  double away = 0;  // mean degrees between the light and what the keys show of it
  for (int seed = 0; seed < 40; ++seed) {
    KeySchedule schedule({});
    LightClock clock;
    FakeRenderer r;
    for (int f = 0; f < 400; ++f) {
      clock.advance((0.8 + 0.4 * ((f * 7919 + seed * 104729) % 101) / 100.0) / 60, 40);
      const Vec3d now = path.direction(clock.travelled());
      const FramePlan plan =
          schedule.next(now, [&](int n) { return path.direction(clock.ahead(n)); });
      r.run(plan);
      if (f == 0) r.most = 0;
      EXPECT_EQ(plan.refreshed, f == 0) << seed << " " << f;
      away += degrees_between(shown_by(plan), now) / (40 * 400);
    }
    EXPECT_LE(r.most, 0.5 + 1e-9) << seed;
  }
  EXPECT_LT(away, 0.3) << "half a step";
}

}  // namespace
}  // namespace atlas
