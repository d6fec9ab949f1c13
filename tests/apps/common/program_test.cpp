// Texts that programs print, whatever files hold.
#include "apps/common/program.h"

#include <gtest/gtest.h>

#include <string>

namespace atlas::app {
namespace {

TEST(PrintedTexts, HoldNoControlCharacters) {
  EXPECT_EQ(printable("a\x1b[31mb\tc\rd\x7f"
                      "e"),
            "a?[31mb?c?d?e");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a?b");
  EXPECT_EQ(printable("\x1f ~"), "? ~");
  EXPECT_EQ(printable("a\nb\n"), "a\nb\n");
  // U+0080 to U+009F control terminals, too; U+00A0 and letters stay.
  EXPECT_EQ(printable("\xc2\x80 \xc2\x9b \xc2\x9f"), "? ? ?");
  EXPECT_EQ(printable("\xc2\xa0 \xc3\xa9 \xe2\x82\xac"), "\xc2\xa0 \xc3\xa9 \xe2\x82\xac");
  EXPECT_EQ(printable("a\xc2"), "a\xc2");
  EXPECT_EQ(printable(""), "");
}

TEST(PrintedTexts, ShortenWordsLongerThanAnyPath) {
  const std::string path(4096, 'p');
  EXPECT_EQ(printable(path), path);
  const std::string word = std::string(100, 'a') + std::string(4000, 'b') + std::string(100, 'c');
  EXPECT_EQ(printable(word), std::string(100, 'a') + "..." + std::string(100, 'c'));
  EXPECT_EQ(printable(path + " " + path), path + " " + path) << "two words";
  EXPECT_EQ(printable("x " + word + "\ny"),
            "x " + std::string(100, 'a') + "..." + std::string(100, 'c') + "\ny");
}

// Characters of several bytes are shown whole or not at all.
TEST(PrintedTexts, CutNoCharacter) {
  std::string euros;
  for (int i = 0; i < 2000; ++i) euros += "\xe2\x82\xac";
  const auto repeated = [](int n) {
    std::string text;
    for (int i = 0; i < n; ++i) text += "\xe2\x82\xac";
    return text;
  };
  EXPECT_EQ(printable(euros), repeated(33) + "..." + repeated(33));
  EXPECT_EQ(printable("a" + euros + "a"), "a" + repeated(33) + "..." + repeated(33) + "a");
}

TEST(PrintedTexts, OfErrorsAreOneLine) {
  EXPECT_EQ(one_line("a\nb\n\n"), "a b");
  EXPECT_EQ(one_line("\n"), "");
  EXPECT_EQ(one_line("a\x07\nb"), "a? b");
}

}  // namespace
}  // namespace atlas::app
