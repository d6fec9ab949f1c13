// The checks of numbers and names that all command lines use.
#include "apps/common/options.h"

#include <gtest/gtest.h>

#include <string>

namespace atlas::app {
namespace {

// Returns what a validator complains of, empty if it accepts the text.
std::string complaint(const CLI::Validator& validator, std::string text) {
  return validator(text);
}

TEST(Checks, RangesIncludeTheirEnds) {
  const CLI::Validator range = within(1, 64);
  for (const char* good : {"1", "64", "7", "1e1", "0x10"}) EXPECT_EQ(complaint(range, good), "");
  for (const char* wrong : {"0", "65", "0.999", "64.001", "nan", "inf", "-inf", "", "7x", "x"})
    EXPECT_EQ(complaint(range, wrong), "'" + std::string(wrong) + "' must be 1..64");
}

// Where the words name no upper end, a number above it is told the end.
TEST(Checks, NumbersBeyondAnUnnamedEndAreToldIt) {
  EXPECT_EQ(complaint(not_negative(), "0"), "");
  EXPECT_EQ(complaint(not_negative(), "1e30"), "");
  for (const char* wrong : {"", "nan", "inf"})
    EXPECT_EQ(complaint(not_negative(), wrong), "'" + std::string(wrong) + "' must be 0 or more");
  EXPECT_EQ(complaint(not_negative(), "2e30"), "'2e30' must be 0 or more, and at most 1e+30");
  EXPECT_EQ(complaint(not_negative(), "-1e-9"), "'-1e-9' must be 0 or more");
  EXPECT_EQ(complaint(positive(), "0"), "'0' must be above 0");
  EXPECT_EQ(complaint(positive(), "1e-30"), "");
  EXPECT_EQ(complaint(positive(), "2e30"), "'2e30' must be above 0, and at most 1e+30");
  EXPECT_EQ(complaint(within(1e-6, 180, "above 0, at most 180"), "181"),
            "'181' must be above 0, at most 180");
}

TEST(Checks, NamesBecomeTheirNumbersInAnyCase) {
  const CLI::Validator names = one_of({{"linear", 4}, {"hold", 2}});
  std::string text = "LinEar";
  EXPECT_EQ(names(text), "");
  EXPECT_EQ(text, "4");
  EXPECT_EQ(complaint(names, "line"), "'line' must be one of hold, linear");
  EXPECT_EQ(complaint(names, "4"), "'4' must be one of hold, linear");
}

}  // namespace
}  // namespace atlas::app
