// Numbers in text, compared with the C library's, and small functions of numbers and names.
#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <tuple>
#include <utility>

#include "libatlas/core/counted.h"
#include "libatlas/core/drop_rounding.h"
#include "libatlas/core/image.h"
#include "libatlas/core/luma.h"
#include "libatlas/core/percentile.h"
#include "libatlas/core/random.h"
#include "libatlas/core/text_buffer.h"
#include "libatlas/core/text_hash.h"
#include "libatlas/files/file_extension.h"
#include "libatlas/files/parse_number.h"
#include "libatlas/files/write_error.h"

namespace atlas {
namespace {

std::string digits(std::mt19937& random, int most) {
  std::string s;
  for (int n = int(random() % unsigned(most + 1)); n > 0; --n) s += char('0' + random() % 10);
  return s;
}

std::string random_number(std::mt19937& random) {
  constexpr const char* kSigns[] = {"", "", "-", "+"};
  std::string s = kSigns[random() % 4] + std::string(random() % 5 == 0 ? random() % 400 : 0, '0');
  s += digits(random, random() % 8 == 0 ? 400 : 17);
  if (random() % 2) s += "." + std::string(random() % 5 == 0 ? random() % 400 : 0, '0');
  if (s.find('.') != s.npos) s += digits(random, 17);
  if (random() % 3 == 0)
    s += (random() % 2 ? "e" : "E") + std::string(kSigns[random() % 4]) +
         std::to_string(random() % (random() % 2 ? 20 : 800));
  return s;
}

// The C library rounds correctly and tells the range apart, too.
TEST(ParseNumber, AgreesWithTheCLibrary) {
  std::mt19937 random(5);
  int tiny = 0, huge = 0;
  for (int i = 0; i < 300000; ++i) {
    const std::string text = random_number(random) + " ";
    char* stop = nullptr;
    const double want = std::strtod(text.c_str(), &stop);
    double got = -7;
    const char* end = parse_number(text.c_str(), text.c_str() + text.size() - 1, got);
    if (stop == text.c_str()) {
      ASSERT_EQ(end, nullptr) << text;
      continue;
    }
    ASSERT_EQ(end, stop) << text;
    ASSERT_EQ(got, want) << text;
    ASSERT_EQ(std::signbit(got), std::signbit(want)) << text;
    tiny += want == 0;
    huge += std::isinf(want);
  }
  EXPECT_GT(tiny, 1000);
  EXPECT_GT(huge, 1000);
}

// The exponent of a number out of range does not tell alone on which side it is.
TEST(ParseNumber, NumbersOutOfRangeBecomeInfiniteOrZero) {
  const std::string zeros(400, '0');
  const double infinite = std::numeric_limits<double>::infinity();
  for (const auto& [text, want] : {std::pair<std::string, double>{"1e999", infinite},
                                   {"-1e999", -infinite},
                                   {"1e-999", 0},
                                   {"0." + zeros + "1", 0},
                                   {"." + zeros + "1", 0},
                                   {"0." + zeros + "1e5", 0},
                                   {"0." + zeros + "1e1000", infinite},
                                   {"1" + zeros, infinite},
                                   {"-1" + zeros + "e-5", -infinite},
                                   {"1" + zeros + "e-1000", 0},
                                   {"1" + zeros + ".5e+5", infinite},
                                   {"1e99999999999999999999", infinite},
                                   {"1e-99999999999999999999", 0}}) {
    double got = -7;
    EXPECT_EQ(parse_number(text.data(), text.data() + text.size(), got), text.data() + text.size());
    EXPECT_EQ(got, want) << text;
    EXPECT_EQ(std::signbit(got), text[0] == '-') << text;
  }
}

TEST(ParseNumber, WhatMicrosoftWroteForNoNumber) {
  const double infinite = std::numeric_limits<double>::infinity(), none = std::nan("");
  for (const auto& [text, want, length] : {std::tuple{"1.#INF ", infinite, 6},
                                           {"-1.#INF00 ", -infinite, 9},
                                           {"+1.#INF00e+000 ", infinite, 14},
                                           {"-1.#INF00e-000x", -infinite, 14},
                                           {"-1.#IND00 ", none, 9},
                                           {"1.#QNAN0 ", none, 8},
                                           {"1.#SNAN/", none, 7},
                                           {"1.#INFe ", infinite, 6},
                                           {"nan ", none, 3},
                                           {"-inf ", -infinite, 4}}) {
    double got = 0;
    EXPECT_EQ(parse_number(text, text + std::strlen(text) - 1, got), text + length) << text;
    EXPECT_TRUE(std::isnan(want) ? std::isnan(got) : got == want) << text;
  }
}

TEST(ParseNumber, NoNumberIsTold) {
  for (const char* text :
       {" ", "+ ", "- ", "+-1 ", "-+1 ", "++1 ", "--1 ", ". ", "-. ", "e5 ", "#IND ", "x1 "}) {
    double got = 0;
    EXPECT_EQ(parse_number(text, text + std::strlen(text) - 1, got), nullptr) << text;
  }
}

template <class T>
std::string text_of(T value) {
  TextBuffer text;
  text.number(value);
  return text.bytes();
}

TEST(TextBuffer, NumbersReadBackAndZerosPrintAlike) {
  std::mt19937_64 random(6);
  for (int i = 0; i < 100000; ++i) {
    const std::uint64_t bits = random();
    double wide;
    float narrow;
    std::memcpy(&wide, &bits, sizeof wide);
    std::memcpy(&narrow, &bits, sizeof narrow);
    if (!std::isfinite(wide) || !std::isfinite(narrow)) continue;
    ASSERT_EQ(std::strtod(text_of(wide).c_str(), nullptr), wide);
    ASSERT_EQ(std::strtof(text_of(narrow).c_str(), nullptr), narrow);
  }
  EXPECT_EQ(text_of(-0.0), "0");
  EXPECT_EQ(text_of(-0.0f), "0");
  EXPECT_EQ(text_of(std::numeric_limits<std::int64_t>::min()), "-9223372036854775808");
}

TEST(TextBuffer, CoordinatesAreThoseOfTheFile) {
  TextBuffer text;
  text.position({0, 1e6, -2.5}, {0.1f, 0.25f, 2.5f});
  text.character(',');
  text.uv({0.5f, -0.0f});
  text.text(";");
  EXPECT_EQ(text.bytes(), "0.1 1000000.25 0,0.5 0;");
}

TEST(DropRounding, DropsWhatIsFarBelowTheSize) {
  EXPECT_EQ(drop_rounding(8e-12, 10), 0);
  EXPECT_EQ(drop_rounding(-8e-12, 10), 0);
  EXPECT_EQ(drop_rounding(std::ldexp(10.0, -40), 10), 0);
  EXPECT_EQ(drop_rounding(1e-11, 10), 1e-11f);
  EXPECT_EQ(drop_rounding(-1e-11, 10), -1e-11f);
  EXPECT_FALSE(std::signbit(drop_rounding(-0.0, 10)));
  EXPECT_FALSE(std::signbit(drop_rounding(-0.0, 0)));
}

// Values that the authors of FNV publish.
TEST(TextHash, IsTheFnvHash) {
  EXPECT_EQ(text_hash(""), 0x811c9dc5u);
  EXPECT_EQ(text_hash("a"), 0xe40c292cu);
  EXPECT_EQ(text_hash("foobar"), 0xbf9cf968u);
  EXPECT_NE(text_hash("\xff"), text_hash("\x7f"));
}

// The standard names the 10000th number of this generator.
TEST(Uniform, HasTheTopBitsOfTheStandardsGenerator) {
  std::mt19937_64 random;
  for (int i = 1; i < 10000; ++i) {
    const double u = uniform(random);
    EXPECT_TRUE(u >= 0 && u < 1);
    EXPECT_EQ(std::ldexp(u, 53), std::floor(std::ldexp(u, 53)));
  }
  EXPECT_NEAR(uniform(random), 9981545732273789042.0 / 18446744073709551616.0, 0x1p-52);
}

TEST(WriteError, TellsWhatToDoAboutRoom) {
  for (const int error : {ENOSPC, EDQUOT, EFBIG})
    EXPECT_EQ(write_error(error),
              std::strerror(error) + std::string(" (make room there, or write elsewhere)"));
  EXPECT_EQ(write_error(EACCES), std::strerror(EACCES));
}

TEST(LowerExtension, ChangesOnlyItsOwnLetters) {
  EXPECT_EQ(lower_extension("A.B/Scene.OBJ"), ".obj");
  EXPECT_EQ(lower_extension("A.B/scene"), "");
  EXPECT_EQ(lower_extension("x.@AZ[`az{\xc3\x84"), ".@az[`az{\xc3\x84");
}

// The product of the first sides wraps around to 0.
TEST(ImageSides, ThatNoMemoryHoldsAreNotWhole) {
  Image8 image;
  EXPECT_TRUE(image.whole());
  image = {2, 1, 3};
  EXPECT_TRUE(image.whole());
  for (const auto& [width, height, channels] : {std::array{1 << 30, 1 << 30, 16},
                                                {-2, -1, 3},
                                                {2, 1, 4},
                                                {3, 1, 3},
                                                {0, 1, 3},
                                                {2, 1, 0}}) {
    image.width = width;
    image.height = height;
    image.channels = channels;
    EXPECT_FALSE(image.whole()) << width << ' ' << height << ' ' << channels;
  }
  image.texels.clear();
  image.width = image.height = 1 << 30;
  image.channels = 16;
  EXPECT_FALSE(image.whole());
}

TEST(Percentile, IsTheValueBelowWhichAShareLies) {
  std::vector<int> values{7, 1, 9, 3, 5, 8, 0, 2, 6, 4};
  EXPECT_EQ(percentile(values, 0), 0);
  EXPECT_EQ(percentile(values, 0.5), 5);
  EXPECT_EQ(percentile(values, 0.99), 9);
  EXPECT_EQ(percentile(values, 1), 9);
  std::vector<float> one{2};
  EXPECT_EQ(percentile(one, 0.5), 2);
}

TEST(Luma, WeighsChannelsInThePrecisionAskedFor) {
  EXPECT_EQ(luma(1.0f, 0.0f, 0.0f), 0.2126f);
  EXPECT_EQ(luma(0.0f, 1.0f, 0.0f), 0.7152f);
  EXPECT_EQ(luma(0.0, 0.0, 1.0), 0.0722);
}

TEST(Counted, HasAnSUnlessThereIsOne) {
  EXPECT_EQ(counted(0, "page"), "0 pages");
  EXPECT_EQ(counted(1, "page"), "1 page");
  EXPECT_EQ(counted(2, "page"), "2 pages");
}

}  // namespace
}  // namespace atlas
