#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "libatlas/shadow/blend.h"
#include "libatlas/shadow/light_path.h"
#include "tests/shadow/directions.h"

namespace atlas {
namespace {

using test::kDegree;

LightPath must(const LightPathOptions& options) {
  Result<LightPath> path = LightPath::make(options);
  EXPECT_TRUE(path.ok()) << path.status().message();
  return *path;
}

using test::cross;
using test::dot;
using test::unit;

TEST(LightPath, ArcRunsAtItsSpeedOnTheGreatCircle) {
  LightPathOptions o;
  o.kind = PathKind::arc;
  o.end = PathEnd::stop;
  o.directions = {{2, 0, 0}, {0, 0, 3}};
  const LightPath path = must(o);
  EXPECT_NEAR(path.length(), 90, 1e-9);
  for (double s = 0; s <= 90; s += 7.5) {
    const Vec3d d = path.direction(s);
    EXPECT_NEAR(d.x, std::cos(s * kDegree), 1e-12);
    EXPECT_NEAR(d.z, std::sin(s * kDegree), 1e-12);
    EXPECT_NEAR(d.y, 0, 1e-12);
  }
  EXPECT_NEAR(path.direction(1000).z, 1, 1e-12);
  EXPECT_NEAR(path.direction(-5).x, 1, 1e-12);
  EXPECT_NEAR(path.direction(std::nan("")).x, 1, 1e-12);
}

// Nearly opposite directions, as of the sun from horizon to horizon at the equator.
TEST(LightPath, ArcOfNearlyHalfATurnKeepsItsSpeed) {
  for (const double short_of : {1e-2, 1e-3, 9e-5, 1e-5, 2e-6}) {
    const double end = std::numbers::pi - short_of;
    LightPathOptions o;
    o.kind = PathKind::arc;
    o.end = PathEnd::stop;
    o.directions = {{1, 0, 0}, {std::cos(end), std::sin(end), 0}};
    const Result<LightPath> path = LightPath::make(o);
    ASSERT_TRUE(path.ok());
    for (int i = 0; i <= 16; ++i) {
      const double at = end * i / 16;
      const Vec3d d = path->direction(at * 180 / std::numbers::pi);
      EXPECT_NEAR(d.x, std::cos(at), 1e-9) << short_of << " " << i;
      EXPECT_NEAR(d.y, std::sin(at), 1e-9) << short_of << " " << i;
    }
  }
}

// The plane of such an arc depends on the last digits of its ends. The sum of nearly opposite
// vectors is exact, so its product with one of them is the plane's normal to full precision.
TEST(LightPath, ArcOfNearlyHalfATurnStaysInItsPlane) {
  std::mt19937 rng(5);
  int made = 0;
  for (int attempt = 0; attempt < 1000; ++attempt) {
    const Vec3d a = unit(test::random_direction(rng)), side = test::random_direction(rng);
    const Vec3d b = unit({2e-6 * side.x - a.x, 2e-6 * side.y - a.y, 2e-6 * side.z - a.z});
    LightPathOptions o;
    o.kind = PathKind::arc;
    o.directions = {a, b};
    const Result<LightPath> path = LightPath::make(o);
    // Ends whose length is not exactly one are divided by it, which turns the plane.
    if (std::hypot(a.x, a.y, a.z) != 1 || std::hypot(b.x, b.y, b.z) != 1 || !path.ok()) continue;
    const Vec3d normal = unit(cross(a, {a.x + b.x, a.y + b.y, a.z + b.z}));
    for (int i = 0; i <= 16; ++i)
      EXPECT_NEAR(dot(path->direction(path->length() * i / 16), normal), 0, 1e-14) << i;
    ++made;
  }
  EXPECT_GE(made, 20);
}

TEST(LightPath, LineStaysOnTheChord) {
  LightPathOptions o;
  o.kind = PathKind::line;
  o.directions = {{1, 1, 0}, {-1, 1, 0}};
  const LightPath path = must(o);
  const Vec3d d = path.direction(path.length() / 4);
  EXPECT_NEAR(d.x / d.y, 0.5, 1e-12);  // a quarter of the way from x = 1 to x = -1 at y = 1
  EXPECT_NEAR(dot(d, d), 1, 1e-12);
}

TEST(LightPath, LengthsOfDirectionsMayBeAnything) {
  for (double scale : {1e-200, 1e200})
    for (PathKind kind : {PathKind::fixed, PathKind::arc, PathKind::line, PathKind::keys}) {
      LightPathOptions o;
      o.kind = kind;
      o.directions = {{scale, 0, 0}};
      if (kind != PathKind::fixed) o.directions.push_back({0, scale, 0});
      const LightPath path = must(o);
      const Vec3d start = path.direction(0), middle = path.direction(45);
      EXPECT_NEAR(start.x, 1, 1e-12) << scale;
      EXPECT_NEAR(dot(middle, middle), 1, 1e-12) << scale;
    }
}

TEST(LightPath, LengthsOfUpAndNorthMayBeAnything) {
  const Vec3d noon = sun_direction({}, 12);
  for (double scale : {1e-200, 1e200}) {
    SunOptions o;
    o.up = {0, scale, 0};
    o.north = {0, 0, -scale};
    const Vec3d d = sun_direction(o, 12);
    EXPECT_NEAR(d.y, noon.y, 1e-12) << scale;
    EXPECT_NEAR(d.z, noon.z, 1e-12) << scale;
  }
}

TEST(LightPath, EndsLoopReturnOrStay) {
  LightPathOptions o;
  o.kind = PathKind::keys;
  o.directions = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (PathEnd end : {PathEnd::loop, PathEnd::back, PathEnd::stop}) {
    o.end = end;
    const LightPath path = must(o);
    EXPECT_NEAR(path.length(), 180, 1e-9);
    EXPECT_NEAR(path.direction(90).y, 1, 1e-9);
    EXPECT_NEAR(path.direction(180).z, 1, 1e-9);
    EXPECT_LT(angle_between(path.direction(30), {std::sqrt(3), 1, 0}), 1e-9);
    EXPECT_LT(angle_between(path.direction(150), {0, 1, std::sqrt(3)}), 1e-9);
    const Vec3d d = path.direction(180 + 90 + 30);
    const Vec3d want = end == PathEnd::loop   ? path.direction(120)
                       : end == PathEnd::back ? path.direction(60)
                                              : path.direction(180);
    EXPECT_LT(angle_between(d, want), 1e-9);
  }
}

// Known positions of the real sun, which do not depend on the formula: the noon elevation is 90 -
// latitude + declination, at the pole the sun circles at constant height, and at the equinox it
// rises due east at six.
TEST(LightPath, TheSunIsWhereItIs) {
  SunOptions s;
  s.latitude = 50;
  s.day_of_year = 172;  // summer solstice, declination 23.44 degrees
  const Vec3d noon = sun_direction(s, 12);
  EXPECT_NEAR(std::asin(noon.y) / kDegree, 90 - 50 + 23.44, 0.6);
  EXPECT_GT(noon.z, 0);  // due south: north is -z
  EXPECT_NEAR(noon.x, 0, 1e-12);
  s.day_of_year = 355;  // winter solstice
  EXPECT_NEAR(std::asin(sun_direction(s, 12).y) / kDegree, 90 - 50 - 23.44, 0.6);
  s.day_of_year = 80;  // spring equinox
  const Vec3d morning = sun_direction(s, 6);
  EXPECT_NEAR(morning.y, 0, 0.012);
  EXPECT_GT(morning.x, 0.99);  // east is +x when up is +y and north is -z
  s.latitude = 90;
  s.day_of_year = 172;
  for (double h = 0; h < 24; h += 3)
    EXPECT_NEAR(std::asin(sun_direction(s, h).y) / kDegree, 23.44, 0.6);
}

TEST(LightPath, SunPathStaysAboveTheHorizonAtConstantSpeed) {
  for (double latitude : {-66.0, -35.0, 0.0, 50.45, 66.0, 80.0}) {
    LightPathOptions o;
    o.sun.latitude = latitude;
    o.sun.start_hour = 9;
    const LightPath path = must(o);
    Vec3d previous = path.direction(0);
    int jumps = 0;
    for (int i = 1; i < 1000; ++i) {
      const Vec3d d = path.direction(i * 0.5);
      EXPECT_GE(d.y, -1e-6) << latitude;
      const double step = angle_between(previous, d) / kDegree;
      // Chords of a small circle differ a little in length from its arc. Jumps are counted
      // separately.
      if (step > 0.6)
        ++jumps;
      else
        EXPECT_NEAR(step, 0.5, 0.01) << latitude << " " << i;
      previous = d;
    }
    EXPECT_LE(jumps, int(500 / path.length()) + 1);
  }
}

TEST(LightPath, SaysWhatIsWrong) {
  LightPathOptions o;
  o.kind = PathKind::arc;
  o.directions = {{1, 0, 0}};
  EXPECT_FALSE(LightPath::make(o).ok());
  o.directions = {{1, 0, 0}, {-1, 0, 0}};
  EXPECT_NE(LightPath::make(o).status().message().find("opposite"), std::string::npos);
  o.directions = {{1, 0, 0}, {0, 0, 0}};
  EXPECT_NE(LightPath::make(o).status().message().find("direction 2"), std::string::npos);
  o.directions = {{0, 0, 0}, {1, 0, 0}};
  EXPECT_NE(LightPath::make(o).status().message().find("direction 1 "), std::string::npos);
  o.directions = {{0, std::nan(""), 0}};
  o.kind = PathKind::fixed;
  EXPECT_NE(LightPath::make(o).status().message().find("direction 1 "), std::string::npos);
  LightPathOptions sun;
  sun.sun.latitude = 80;
  sun.sun.day_of_year = 355;
  EXPECT_NE(LightPath::make(sun).status().message().find("does not rise"), std::string::npos);
  sun.sun.latitude = 91;
  EXPECT_FALSE(LightPath::make(sun).ok());
  sun = {};
  sun.sun.north = sun.sun.up;
  EXPECT_FALSE(LightPath::make(sun).ok());
}

TEST(LightPath, TakesEveryDayPlaceAndHour) {
  const auto made = [](int day, double latitude, double hour) {
    LightPathOptions o;
    o.sun.day_of_year = day;
    o.sun.latitude = latitude;
    o.sun.start_hour = hour;
    return LightPath::make(o).ok();
  };
  EXPECT_TRUE(made(1, 0, 0));
  EXPECT_TRUE(made(366, 0, 23.99));
  EXPECT_TRUE(made(172, 90, 12));
  EXPECT_TRUE(made(355, -90, 12));
  EXPECT_FALSE(made(0, 0, 12));
  EXPECT_FALSE(made(367, 0, 12));
  EXPECT_FALSE(made(172, 90.01, 12));
  EXPECT_FALSE(made(172, 0, 24));
  EXPECT_FALSE(made(172, 0, -0.01));
}

// Infinite travel has no remainder on a loop, and counts as none on every path.
TEST(LightPath, TravelThatIsNotFiniteCountsAsNone) {
  const double infinity = std::numeric_limits<double>::infinity();
  LightPathOptions arc, keys, line, sun;
  arc.kind = PathKind::arc;
  arc.directions = {{2, 0, 0}, {0, 0, 3}};
  keys.kind = PathKind::keys;
  keys.directions = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  line.kind = PathKind::line;
  line.directions = {{1, 1, 0}, {-1, 1, 0}};
  for (LightPathOptions o : {arc, keys, line, sun})
    for (const PathEnd end : {PathEnd::loop, PathEnd::back, PathEnd::stop}) {
      o.end = end;
      const LightPath path = must(o);
      for (const double degrees : {infinity, -infinity, std::nan(""), -1.0})
        EXPECT_EQ(path.direction(degrees), path.direction(0)) << int(o.kind) << " " << degrees;
    }
}

// At sunset the sun is in the west and on the horizon, whatever hour that is.
TEST(LightPath, ASunThatStopsStaysAtSunset) {
  for (const double latitude : {-35.0, 0.0, 50.45}) {
    LightPathOptions o;
    o.end = PathEnd::stop;
    o.sun.latitude = latitude;
    const LightPath path = must(o);
    const Vec3d last = path.direction(path.length());
    EXPECT_NEAR(last.y, 0, 1e-9) << latitude;
    EXPECT_LT(last.x, -0.5) << latitude;
    for (const double degrees : {path.length() + 1, 500.0, 1e9}) {
      EXPECT_EQ(path.direction(degrees), last) << latitude << " " << degrees;
      EXPECT_EQ(path.hour(degrees), path.hour(path.length())) << latitude << " " << degrees;
    }
    EXPECT_NEAR(path.hour(0), 9, 1e-9);
    EXPECT_GT(path.hour(1e9), 12);
  }
}

TEST(LightPath, OnlyTheSunsPathHasHours) {
  LightPathOptions o;
  o.kind = PathKind::fixed;
  o.directions = {{1, 2, 3}};
  EXPECT_TRUE(std::isnan(must(o).hour(10)));
}

// A direction may be given twice, for instance by a key that was recorded while the light rested.
TEST(LightPath, ARepeatedDirectionChangesNothing) {
  const Vec3d a{1, 0, 0}, b{1, 2, 3}, c{0, 0, 1};
  LightPathOptions o;
  o.kind = PathKind::keys;
  o.directions = {a, b, c};
  const LightPath once = must(o);
  for (const std::vector<Vec3d>& keys :
       {std::vector<Vec3d>{a, a, b, c}, {a, b, b, c}, {a, b, c, c}, {a, a, a, b, b, b, c, c, c}}) {
    o.directions = keys;
    const LightPath path = must(o);
    EXPECT_NEAR(path.length(), once.length(), 1e-9);
    for (double degrees = 0; degrees <= 2.5 * once.length(); degrees += 0.25) {
      const Vec3d d = path.direction(degrees), want = once.direction(degrees);
      EXPECT_NEAR(d.x, want.x, 1e-12) << degrees;
      EXPECT_NEAR(d.y, want.y, 1e-12) << degrees;
      EXPECT_NEAR(d.z, want.z, 1e-12) << degrees;
    }
  }
  o.directions = {b, b};
  EXPECT_EQ(must(o).length(), 0);
  EXPECT_EQ(must(o).direction(10), must(o).direction(0));
}

TEST(LightPath, TakesAsManyDirectionsAsItsKindHas) {
  const auto made = [](PathKind kind, std::size_t count) {
    const std::vector<Vec3d> all{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}};
    LightPathOptions o;
    o.kind = kind;
    o.directions.assign(all.begin(), all.begin() + std::ptrdiff_t(count));
    return LightPath::make(o).ok();
  };
  for (std::size_t count = 0; count <= 4; ++count) {
    EXPECT_EQ(made(PathKind::fixed, count), count == 1) << count;
    EXPECT_EQ(made(PathKind::line, count), count == 2) << count;
    EXPECT_EQ(made(PathKind::arc, count), count == 2) << count;
    EXPECT_EQ(made(PathKind::keys, count), count >= 2) << count;
  }
}

// A north that leans against the vertical is made horizontal, however little is left of it.
TEST(LightPath, NorthMayBeNearlyVertical) {
  LightPathOptions upright;
  const LightPath want = must(upright);
  for (const double degrees : {1.0, 45.0, 135.0, 179.0}) {
    LightPathOptions o;
    o.sun.north = {0, std::cos(degrees * kDegree), -std::sin(degrees * kDegree)};
    const Result<LightPath> path = LightPath::make(o);
    ASSERT_TRUE(path.ok()) << degrees;
    for (double travel = 0; travel < 100; travel += 10)
      EXPECT_LT(angle_between(path->direction(travel), want.direction(travel)), 1e-9) << degrees;
  }
}

// The declinations of the mean days of the months in Solar Engineering of Thermal Processes (Duffie
// and Beckman 2006), table 1.6.1, which are rounded to a tenth of a degree.
TEST(LightPath, DeclinationsAreThoseOfThePublishedTable) {
  const std::pair<int, double> table[] = {{17, -20.9}, {47, -13.0}, {75, -2.4},   {105, 9.4},
                                          {135, 18.8}, {162, 23.1}, {198, 21.2},  {228, 13.5},
                                          {258, 2.2},  {288, -9.6}, {318, -18.9}, {344, -23.0}};
  for (const auto& [day, degrees] : table)
    EXPECT_NEAR(sun_declination(day) / kDegree, degrees, 0.0501) << day;
}

}  // namespace
}  // namespace atlas
