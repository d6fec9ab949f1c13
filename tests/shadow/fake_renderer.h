// What tests of the schedule share: lights, and a renderer that checks every plan.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "libatlas/core/vec.h"
#include "libatlas/shadow/blend.h"
#include "libatlas/shadow/schedule.h"
#include "tests/shadow/directions.h"

namespace atlas::test {

inline double degrees_between(const Vec3d& a, const Vec3d& b) {
  return angle_between(a, b) / kDegree;
}

// Lights that turn about z: `turned` low over the horizon, where it moves a little less than so
// many degrees, and `circled` on the horizon, where it moves exactly so many.
inline Vec3d turned(double degrees) {
  return {std::cos(degrees * kDegree), std::sin(degrees * kDegree), 0.2};
}
inline Vec3d circled(double degrees) {
  return {std::cos(degrees * kDegree), std::sin(degrees * kDegree), 0};
}

// Holds what a renderer would hold: for each slot the direction and how much of its map is drawn.
// Checks every rule that a plan must keep, and counts the work.
struct FakeRenderer {
  struct Map {
    Vec3d direction;
    double done = -1;
  };
  std::map<int, Map> maps;
  double work = 0, most = 0;
  int begun = 0;

  void run(const FramePlan& plan) {
    double now = 0;
    for (const MapWork& w : plan.work) {
      Map& map = maps[w.slot];
      ASSERT_GE(w.slot, 0);
      ASSERT_LT(w.slot, KeySchedule::kSlots);
      if (w.begin == 0) {
        map = {w.direction, 0};
        ++begun;
      }
      ASSERT_EQ(map.direction, w.direction) << "a map is drawn for one direction only";
      ASSERT_NEAR(map.done, w.begin, 1e-12) << "slices leave no gap";
      map.done = w.end;
      now += w.end - w.begin;
    }
    work += now;
    most = std::max(most, now);
    for (const auto& [slot, direction] :
         {std::pair{plan.from, plan.from_direction}, {plan.to, plan.to_direction}}) {
      ASSERT_EQ(maps[slot].done, 1) << "a sampled map is complete";
      ASSERT_EQ(maps[slot].direction, direction) << "a map is sampled with its own direction";
    }
    ASSERT_GE(plan.t, 0);
    if (plan.from == plan.to) {
      ASSERT_EQ(plan.t, 0) << "one map has no time between two";
    }
    ASSERT_LT(plan.t, 1);
  }
};

}  // namespace atlas::test
