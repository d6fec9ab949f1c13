// The text form of light paths.
#include <gtest/gtest.h>

#include <clocale>
#include <vector>

#include "libatlas/shadow/light_path.h"
#include "tests/support/foreign_locale.h"

namespace atlas {
namespace {

TEST(LightPathText, IsRead) {
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

// The numbers of one direction are separated by commas, before which nothing may stand. Blanks may
// stand before each number, as in text that was typed by hand.
TEST(LightPathText, BlanksMayPrecedeNumbersButSeparateNothing) {
  const Result<LightPathOptions> arc = parse_light_path("arc: 1, 2,  3; -4,   5,6", {});
  ASSERT_TRUE(arc.ok()) << arc.status().message();
  EXPECT_EQ(arc->directions, (std::vector<Vec3d>{{1, 2, 3}, {-4, 5, 6}}));
  const Result<LightPathOptions> sun = parse_light_path("sun: 172, -50, 9", {});
  ASSERT_TRUE(sun.ok()) << sun.status().message();
  EXPECT_EQ(sun->sun.latitude, -50);
  for (const char* bad :
       {"fixed:1 2 3", "fixed:1/2/3", "fixed:1,2x3", "fixed:1,2,3x", "fixed:1,2:3",
        "fixed: ", "fixed:1 ,2,3", "sun:172 50 9", "arc:1,2,3,4,5,6"})
    EXPECT_FALSE(parse_light_path(bad, {}).ok()) << bad;
}

TEST(LightPathText, ReplacesTheDirectionsAndKeepsWhatItDoesNotName) {
  LightPathOptions before;
  before.end = PathEnd::back;
  before.directions = {{7, 8, 9}, {9, 8, 7}};
  before.sun.latitude = 12;
  const Result<LightPathOptions> arc = parse_light_path("arc:1,2,3;4,5,6", before);
  ASSERT_TRUE(arc.ok()) << arc.status().message();
  EXPECT_EQ(arc->directions, (std::vector<Vec3d>{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(arc->end, PathEnd::back);
  EXPECT_EQ(arc->sun.latitude, 12);
  const Result<LightPathOptions> sun = parse_light_path("sun", before);
  ASSERT_TRUE(sun.ok()) << sun.status().message();
  EXPECT_EQ(sun->end, PathEnd::back);
  EXPECT_EQ(sun->sun.latitude, 12);
}

}  // namespace
}  // namespace atlas
