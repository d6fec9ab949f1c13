#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

#include "libatlas/scene/files/text_scanner.h"

namespace atlas {
namespace {

TEST(TextScanner, NumbersAgreeWithTheLibrary) {
  std::mt19937_64 random(7);
  const char* formats[] = {"{}", "{:.3f}", "{:.17g}", "{:e}", "{:.0f}", "+{}", "{:.25f}"};
  for (int i = 0; i < 20000; ++i) {
    const double magnitude = std::exp(std::uniform_real_distribution<>(-40, 40)(random));
    const std::string text = fmt::format(fmt::runtime(formats[i % 7]), magnitude);
    for (const std::string& s : {text, text[0] == '+' ? text : "-" + text}) {
      const std::string line = "  " + s + " x\n";
      TextScanner scan(line.data(), line.data() + line.size() - 1);
      double value = 0;
      ASSERT_TRUE(scan.number(value)) << s;
      EXPECT_EQ(value, std::strtod(s.c_str(), nullptr)) << s;
      EXPECT_EQ(scan.word(), "x");
    }
  }
}

// A backslash joins lines, but not if it ends a comment.
TEST(TextScanner, CommentsAreNotContinued) {
  for (const char* comment : {"# a \\\n", "1 # a \\\n", "g a # C:\\tmp\\\r\n", " \t# \\\n"}) {
    const std::string text = comment + std::string("next\n");
    TextScanner scan(text.data(), text.data() + text.size());
    scan.next_line();
    EXPECT_EQ(scan.line(), 1u) << comment;
    EXPECT_EQ(scan.word(), "next") << comment;
  }
  const std::string text = "g a#1 \\\nb\nnext\n";
  TextScanner scan(text.data(), text.data() + text.size());
  scan.next_line();
  EXPECT_EQ(scan.line(), 2u);
  EXPECT_EQ(scan.word(), "next");
}

TEST(TextScanner, OddNumbers) {
  const auto parse = [](std::string s, double& value) {
    s += '\n';
    TextScanner scan(s.data(), s.data() + s.size() - 1);
    return scan.number(value);
  };
  double v = 0;
  for (const char* good : {"5.", ".5", "-.5e3", "1e5", "1E-5", "nan", "inf", "-inf", "+3"}) {
    EXPECT_TRUE(parse(good, v)) << good;
  }
  for (const char* bad : {"", ".", "-", "+-3", "1.2.3", "12a", "e5", "0x10", "1,5", "--1"}) {
    EXPECT_FALSE(parse(bad, v)) << bad;
  }
  for (const char* none : {"-1.#IND", "-1.#IND00", "1.#QNAN", "+1.#SNAN0", "-1.#IND00e+000"})
    EXPECT_TRUE(parse(none, v) && std::isnan(v)) << none;
  EXPECT_TRUE(parse("1.#INF", v) && v > 0 && std::isinf(v));
  EXPECT_TRUE(parse("-1.#INF00", v) && v < 0 && std::isinf(v));
  for (const char* bad : {"1.#IN", "2.#IND", "1.#INDx", "1.#INF00e+"}) {
    EXPECT_FALSE(parse(bad, v) && !std::isfinite(v)) << bad;
  }
  EXPECT_TRUE(parse("1e999", v) && std::isinf(v));
  EXPECT_TRUE(parse("-1e999", v) && v < 0 && std::isinf(v));
  EXPECT_TRUE(parse("1e-999", v) && v == 0);
  EXPECT_TRUE(parse("1" + std::string(400, '0'), v) && std::isinf(v));
  EXPECT_TRUE(parse("0." + std::string(400, '0') + "1", v) && v == 0);
}

}  // namespace
}  // namespace atlas
