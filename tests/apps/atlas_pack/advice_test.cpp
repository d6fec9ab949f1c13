// When atlas-pack advises other pages, and which ones it names.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "libatlas/image/image_io.h"
#include "tests/apps/atlas_pack/run_pack.h"

namespace atlas::test {
namespace {

// Lists of rectangles of which no two fit one page.
class PageAdvice : public AtlasPack {
 protected:
  // Returns the line of the advice, or nothing if there is none.
  std::string advice(int items, const std::string& size, const std::string& options) const {
    std::string list;
    for (int i = 0; i < items; ++i) list += size + "\n";
    write("l.csv", list);
    const RunResult r = run("rects l.csv -o p.csv " + options);
    const std::size_t at = r.output.find(fmt::format("{} pages, each a texture of", items));
    EXPECT_EQ(at == std::string::npos, r.output.find("slow to load") == std::string::npos);
    return at == std::string::npos ? "" : r.output.substr(at, r.output.find('\n', at) - at);
  }
  static std::string words(int pages, int side, int fewer) {
    return fmt::format(
        "{} pages, each a texture of its own, are slow to load and to draw (--page {}x{} takes "
        "about {})",
        pages, side, side, fewer);
  }
};

TEST_F(PageAdvice, IsForMoreThan64Pages) {
  EXPECT_EQ(advice(64, "16,16", "--page 16"), "");
  EXPECT_EQ(advice(65, "16,16", "--page 16"), words(65, 32, 17));
}

TEST_F(PageAdvice, NamesTheSmallestSideThatNeedsAtMost32Pages) {
  EXPECT_EQ(advice(128, "16,16", "--page 16"), words(128, 32, 32));
  EXPECT_EQ(advice(129, "16,16", "--page 16"), words(129, 64, 9));
}

// Larger textures are not for every graphics card.
TEST_F(PageAdvice, NamesNoSideAbove8192) {
  EXPECT_EQ(advice(65, "4096,4096", "--page 4096"), words(65, 8192, 17));
  EXPECT_EQ(advice(200, "4096,4096", "--page 4096"), words(200, 8192, 50));
  EXPECT_EQ(advice(65, "4097,4097", "--page 4097"), "");
}

// 65 pages of 9 x 16 texels have the area of 9.1 pages of 32 x 32.
TEST_F(PageAdvice, CountsByTheLongerSideOfAllPages) {
  EXPECT_EQ(advice(65, "9,16", "--page 16 --crop"), words(65, 32, 10));
  EXPECT_EQ(advice(65, "16,9", "--page 16 --crop"), words(65, 32, 10));
}

// Whoever limits the pages and gets an error is told to allow more of them.
TEST_F(PageAdvice, IsNotGivenWhereItemsAreLeftOut) {
  std::string list;
  for (int i = 0; i < 80; ++i) list += "16,16\n";
  write("l.csv", list);
  const RunResult r = run("rects l.csv -o p.csv --page 16 --max-pages 70");
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_NE(r.output.find("no place for 10 of 80 items"), std::string::npos) << r.output;
  EXPECT_EQ(r.output.find("slow to load"), std::string::npos) << r.output;
}

// A page is mostly empty if less than a quarter of it is used. Of several, only the last may be.
TEST_F(AtlasPack, AdviceToCropIsForPagesOfSpritesBelowAQuarter) {
  fs::create_directories(dir_ / "in");
  const auto told = [&](const std::string& command) {
    const RunResult r = run(command);
    EXPECT_EQ(r.exit_code, 0) << r.output;
    return r.output.find("are mostly empty") != std::string::npos;
  };
  ASSERT_TRUE(write_png(dir_ / "in/a.png", Image8(31, 32, 3, 9), {}).ok());
  EXPECT_TRUE(told("images in -o s --page 64"));
  EXPECT_FALSE(told("images in -o s --page 64 --crop"));
  ASSERT_TRUE(write_png(dir_ / "in/a.png", Image8(32, 32, 3, 9), {}).ok());
  EXPECT_FALSE(told("images in -o s --page 64"));
  // The border leaves room for one sprite a page.
  const std::string narrow = "images in -o s --page 64 --border 16";
  ASSERT_TRUE(write_png(dir_ / "in/a.png", Image8(20, 20, 3, 9), {}).ok());
  EXPECT_TRUE(told(narrow));
  ASSERT_TRUE(write_png(dir_ / "in/b.png", Image8(20, 20, 3, 8), {}).ok());
  EXPECT_TRUE(told(narrow));
  // Lists of rectangles have the page that somebody wants.
  write("l.csv", "8,8\n");
  EXPECT_FALSE(told("rects l.csv -o p.csv --page 64"));
}

}  // namespace
}  // namespace atlas::test
