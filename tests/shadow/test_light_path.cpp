#include <gtest/gtest.h>

#include <cmath>
#include <locale>
#include <numbers>

#include "libatlas/shadow/blend.h"
#include "libatlas/shadow/light_path.h"
#include "tests/support/foreign_locale.h"

namespace atlas {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

LightPath must(const LightPathOptions& options) {
  Result<LightPath> path = LightPath::make(options);
  EXPECT_TRUE(path.ok()) << path.status().message();
  return *path;
}

double dot(const Vec3d& a, const Vec3d& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

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

TEST(LightPath, Text) {
  EXPECT_EQ(parse_light_path("sun:10,-33.5,8", {})->sun.latitude, -33.5);
  EXPECT_EQ(parse_light_path("sun", {})->kind, PathKind::sun);
  EXPECT_EQ(parse_light_path("sun:1,0,0", {})->sun.day_of_year, 1);
  EXPECT_EQ(parse_light_path("sun:366,0,0", {})->sun.day_of_year, 366);
  EXPECT_EQ(parse_light_path("line:1,2,3;4,5,6", {})->kind, PathKind::line);
  EXPECT_EQ(parse_light_path("fixed:1,2,3", {})->directions, (std::vector<Vec3d>{{1, 2, 3}}));
  const Result<LightPathOptions> keys = parse_light_path("keys:1,2,3;4,5,6;-7,8,1e-3", {});
  ASSERT_TRUE(keys.ok());
  EXPECT_EQ(keys->kind, PathKind::keys);
  EXPECT_EQ(keys->directions, (std::vector<Vec3d>{{1, 2, 3}, {4, 5, 6}, {-7, 8, 1e-3}}));
  const Result<LightPathOptions> arc = parse_light_path("arc:1,2,3;-1,.5,1e1", {});
  ASSERT_TRUE(arc.ok());
  EXPECT_EQ(arc->directions[1], (Vec3d{-1, 0.5, 10}));
  for (const char* bad :
       {"", "moon:1,2,3", "arc", "arc:", "arc:1,2", "arc:1,2,3;", "sun:1,2", "sun:1,2,x",
        "fixed:1,2,3,4", "sun:1e99,0,0", "sun:1.5,0,0", "sun:0,0,0", "sun:367,0,0", "fixed:1,,2"})
    EXPECT_FALSE(parse_light_path(bad, {}).ok()) << bad;
}

// A host program may have set a locale whose decimal point is a comma.
TEST(LightPathText, ReadsTheSameInEveryLocale) {
  const test::ForeignLocale german(LC_NUMERIC, "de_DE", "ISO-8859-1");
  if (!german.entered()) GTEST_SKIP() << "no locale with a decimal comma can be made here";
  ASSERT_EQ(*std::localeconv()->decimal_point, ',');
  const auto fixed = parse_light_path("fixed:1,2.5,1", {});
  ASSERT_TRUE(fixed.ok()) << fixed.status().message();
  EXPECT_EQ(fixed->directions[0], (Vec3d{1, 2.5, 1}));
  const auto sun = parse_light_path("sun:172,50.45,9", {});
  ASSERT_TRUE(sun.ok()) << sun.status().message();
  EXPECT_EQ(sun->sun.latitude, 50.45);
}

}  // namespace
}  // namespace atlas
