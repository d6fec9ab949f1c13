// Lengths, units and amounts of memory, as users write them.
#include "apps/common/quantity.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace atlas::app {
namespace {

TEST(Lengths, AreMetres) {
  for (const auto& [text, metres] : {std::pair("3", 3.0),
                                     {"3m", 3.0},
                                     {"3 m", 3.0},
                                     {"5mm", 0.005},
                                     {"5  cm", 0.05},
                                     {"2in", 0.0508},
                                     {"10ft", 3.048},
                                     {"1.5km", 1500.0},
                                     {"1e-2", 0.01},
                                     {"2e3mm", 2.0}}) {
    const std::optional<double> length = parse_length(text);
    ASSERT_TRUE(length) << text;
    EXPECT_DOUBLE_EQ(*length, metres) << text;
  }
  for (const char* wrong : {"", "m", "0", "-1", "0mm", "nan", "inf", "1e999", "5 parsec", "5mm ",
                            " 5mm", "5mmm", "5M", "+5", "1,5m"})
    EXPECT_EQ(parse_length(wrong), std::nullopt) << wrong;
}

// A unit is a name or a number of metres, but not both.
TEST(Units, AreNamesOrNumbers) {
  for (const auto& [text, metres] : {std::pair("m", 1.0),
                                     {"cm", 0.01},
                                     {"mm", 0.001},
                                     {"in", 0.0254},
                                     {"ft", 0.3048},
                                     {"km", 1000.0},
                                     {"2.5", 2.5},
                                     {"1e-12", 1e-12},
                                     {"1e24", 1e24}}) {
    const std::optional<double> unit = parse_unit(text);
    ASSERT_TRUE(unit) << text;
    EXPECT_DOUBLE_EQ(*unit, metres) << text;
  }
  for (const char* wrong : {"", "5mm", "1 m", "ell", "0", "-1", "nan", "9e-13", "1.1e24"})
    EXPECT_EQ(parse_unit(wrong), std::nullopt) << wrong;
}

TEST(Bytes, HaveDecimalAndBinaryPrefixes) {
  constexpr std::int64_t k = 1000, ki = 1024;
  for (const auto& [text, bytes] : {std::pair("1", std::int64_t{1}),
                                    {"7b", 7},
                                    {"7 B", 7},
                                    {"2k", 2 * k},
                                    {"2kB", 2 * k},
                                    {"2Kb", 2 * k},
                                    {"3MB", 3 * k * k},
                                    {"4G", 4 * k * k * k},
                                    {"5TB", 5 * k * k * k * k},
                                    {"2KiB", 2 * ki},
                                    {"2ki", 2 * ki},
                                    {"3 MiB", 3 * ki * ki},
                                    {"4gib", 4 * ki * ki * ki},
                                    {"5Ti", 5 * ki * ki * ki * ki},
                                    {"1.5kB", 1500},
                                    {"0.5MiB", 512 * ki},
                                    {"9e18", 9'000'000'000'000'000'000}})
    EXPECT_EQ(parse_bytes(text), bytes) << text;
  for (const char* wrong : {"", "0", "0.5", "-1", "MB", "1x", "1kx", "1kBx", "1kib b", "1PB", "1iB",
                            "1bi", "1 kBit", "9.1e18", "1e30TB", "nan", "inf"})
    EXPECT_EQ(parse_bytes(wrong), std::nullopt) << wrong;
}

}  // namespace
}  // namespace atlas::app
