// Tests atlas-pack rects, which packs lists of rectangles.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "libatlas/image/image_io.h"
#include "tests/apps/atlas_pack/run_pack.h"
#include "tests/support/full_disk.h"
#include "tests/support/slowness.h"

namespace atlas::test {
namespace {

TEST_F(AtlasPack, RectsFromCsvToCsv) {
  write("sizes.csv", "name,width,height\na,60,10\n\"b,c\",4,10\n");
  const RunResult r = run("rects sizes.csv --page 64x32 -o placed.csv --preview p.svg");
  EXPECT_EQ(r.exit_code, 0) << r.output;
  EXPECT_EQ(read("placed.csv"),
            "name,page,x,y,width,height,rotated\na,0,0,0,60,10,0\n\"b,c\",0,60,0,4,10,0\n");
  EXPECT_NE(read("p.svg").find("<svg"), std::string::npos);
}

TEST_F(AtlasPack, CommasInQuotesSeparateNothing) {
  write("a.csv", "name;width;height\n\"b, c\";3;4\nd;5;6\n");
  const RunResult r = run("rects a.csv -o a.out.csv --page 8x10");
  EXPECT_EQ(r.exit_code, 0) << r.output;
  EXPECT_NE(read("a.out.csv").find("\"b, c\",0,"), std::string::npos);
}

TEST_F(AtlasPack, CommentsFollowLinesAndNamesHoldNumberSigns) {
  write("a.csv",
        "name,width,height\n  # all, of them\na#1,3,4\ntile #2, 5, 6  # the second, at last\n");
  EXPECT_EQ(run("rects a.csv -o a.out.csv --page 16x8").exit_code, 0);
  const std::string placed = read("a.out.csv");
  EXPECT_NE(placed.find("a#1,0,"), std::string::npos) << placed;
  EXPECT_NE(placed.find("tile #2,0,"), std::string::npos) << placed;
  EXPECT_EQ(std::count(placed.begin(), placed.end(), '\n'), 3);
  write("b.txt", "10 10 2 # page, count\n\t# two\n10 4 # a, b\n5 6\n");
  const RunResult r = run("rects b.txt -o b.csv --json");
  EXPECT_EQ(r.exit_code, 0) << r.output;
  EXPECT_NE(r.output.find("\"width\":10"), std::string::npos) << r.output;
}

// The search for a comment once took quadratic time: minutes for this line.
TEST_F(AtlasPack, LinesOfNumberSignsTakeNoTime) {
  std::string line = "a";
  for (int i = 0; i < 100000; ++i) line += " #";
  write("signs.csv", line + ",3,4\n");
  const auto start = std::chrono::steady_clock::now();
  const RunResult r = run("rects signs.csv -o a.json");
  EXPECT_EQ(r.exit_code, 0) << r.output.substr(0, 400);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(3) * kSlowness);
}

// Published instances begin with `width height count`; --page overrides them.
TEST_F(AtlasPack, InstancesSayTheirPage) {
  write("a.txt", "# three\n10 10 3\n10 4\n5 6\n5 6\n");
  const RunResult r = run("rects a.txt -o a.csv --json");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  const auto summary = nlohmann::json::parse(r.output);
  EXPECT_EQ(summary["items"], 3);
  EXPECT_EQ(summary["pages"], nlohmann::json::parse(R"([{"width":10,"height":10}])"));
  const RunResult wider = run("rects a.txt -o a.csv --page 20x10 --json");
  EXPECT_EQ(nlohmann::json::parse(wider.output)["pages"][0]["width"], 20);
  write("strip.txt", "10 0 2\n10 4\n10 6\n");
  const RunResult strip = run("rects strip.txt -o a.csv --json");
  EXPECT_EQ(nlohmann::json::parse(strip.output)["pages"][0]["height"], 10) << strip.output;
  write("cut.txt", "10 10 3\n10 4\n");
  const RunResult cut = run("rects cut.txt -o cut.csv");
  EXPECT_EQ(cut.exit_code, 1);
  EXPECT_NE(cut.output.find("cut.txt:1: a page of 10 x 10 and 3 rectangles"), std::string::npos)
      << cut.output;
  write("named.txt", "1 10 3\n2 10 4\n");  // all lines begin with a name, so it is a list
  EXPECT_EQ(nlohmann::json::parse(run("rects named.txt -o a.csv --json").output)["items"], 2);
}

TEST_F(AtlasPack, HeadersFollowCommentsAndExtensionsMayBeCapitals) {
  write("S.CSV", "# sizes\n\nname,width,height\na,3,4\n");
  ASSERT_EQ(run("rects S.CSV -o A.CSV --preview P.SVG").exit_code, 0);
  EXPECT_EQ(read("A.CSV"), "name,page,x,y,width,height,rotated\na,0,0,0,3,4,0\n");
  EXPECT_NE(read("P.SVG").find("<svg"), std::string::npos);
  write("S.JSON", "[[3,4]]");
  ASSERT_EQ(run("rects S.JSON -o B.JSON").exit_code, 0);
  EXPECT_EQ(nlohmann::json::parse(read("B.JSON"))["frames"]["0"]["frame"]["h"], 4);
}

// Blocks of compressed texels are counted from the upper edge, whatever the height of the page.
TEST_F(AtlasPack, AlignedItemsBeginAtMultiplesFromTheUpperLeftCorner) {
  write("sizes.csv",
        "\xef\xbb\xbf"
        "13,7\n9,5\n21,6\n7,7\n30,3\n5,18\n");
  for (const char* page : {"33x0", "33x37", "64x64 --crop", "45x0 --border 1"}) {
    const RunResult r = run(fmt::format("rects sizes.csv --align 4 --page {} -o q.csv", page));
    ASSERT_EQ(r.exit_code, 0) << r.output;
    std::istringstream lines(read("q.csv"));
    std::string line;
    int items = 0;
    for (std::getline(lines, line); std::getline(lines, line); ++items) {
      int number = 0, on = 0, x = 0, y = 0;
      ASSERT_EQ(std::sscanf(line.c_str(), "%d,%d,%d,%d", &number, &on, &x, &y), 4) << line;
      EXPECT_EQ(x % 4, 0) << page << ": " << line;
      EXPECT_EQ(y % 4, 0) << page << ": " << line;
    }
    EXPECT_EQ(items, 6);
  }
}

TEST_F(AtlasPack, RectsFromJsonToBothJsonLayouts) {
  write("sizes.json", R"([[8, 8], {"name": "x", "w": 4, "h": 2}])");
  ASSERT_EQ(run("rects sizes.json --page 16 -o hash.json").exit_code, 0);
  const auto hash = nlohmann::json::parse(read("hash.json"));
  EXPECT_EQ(hash["frames"]["x"]["frame"]["w"], 4);
  ASSERT_EQ(run("rects sizes.json --page 16 --data array -o array.json").exit_code, 0);
  const auto array = nlohmann::json::parse(read("array.json"));
  ASSERT_EQ(array["frames"].size(), 2u);
  EXPECT_EQ(array["frames"][1]["filename"], "x");
  const RunResult summary = run("rects sizes.json --page 16 --json -o s.csv");
  EXPECT_EQ(nlohmann::json::parse(summary.output)["items"], 2);
}

TEST_F(AtlasPack, WhatIsWrongIsSaid) {
  write("bad.csv", "1,2\n3,x\n");
  const RunResult bad = run("rects bad.csv -o q.csv");
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_NE(bad.output.find("bad.csv:2:"), std::string::npos) << bad.output;
  EXPECT_FALSE(fs::exists(dir_ / "q.csv"));
  EXPECT_EQ(run("rects missing.csv -o q.csv").exit_code, 1);
  EXPECT_EQ(run("rects bad.csv").exit_code, 2);
  EXPECT_EQ(run("rects bad.csv -o q.csv --page nonsense").exit_code, 2);
  write("large.csv", "100,1\n5,5\n");
  const RunResult large = run("rects large.csv --page 64 -o q.csv");
  EXPECT_EQ(large.exit_code, 1);
  EXPECT_NE(large.output.find("larger than the page"), std::string::npos);
  EXPECT_NE(large.output.find("q.csv: 1 of 2 items on 1 page, "), std::string::npos);
  EXPECT_NE(read("q.csv").find("1,0,"), std::string::npos);  // the other one is placed
}

TEST_F(AtlasPack, VeryManyPagesAreNamedWithTheLargerOnesThatWouldDo) {
  std::string list;
  for (int i = 0; i < 300; ++i) list += fmt::format("{},{}\n", 30 + i % 3, 30 + i % 2);
  write("sizes.csv", list);
  const RunResult many = run("rects sizes.csv -o placed.csv --page 64x64");
  EXPECT_EQ(many.exit_code, 0);
  EXPECT_NE(many.output.find("75 pages, each a texture of its own, are slow to load and to draw "
                             "(--page 128x128 takes about 19)"),
            std::string::npos)
      << many.output;
  EXPECT_EQ(run("rects sizes.csv -o placed.csv --page 128x128").output.find("slow"),
            std::string::npos);
}

// A lone carriage return once did not end a line: "1,2" and "3,4" became one rectangle "1" of 23 x
// 4.
TEST_F(AtlasPack, LinesMayEndByCarriageReturnsAlone) {
  write("mac.csv", "name,width,height\ra,10,20\rb,30,40\r");
  ASSERT_EQ(run("rects mac.csv -o placed.csv").exit_code, 0);
  EXPECT_NE(read("placed.csv").find("a,0,"), std::string::npos) << read("placed.csv");
  EXPECT_NE(read("placed.csv").find(",30,40,0\n"), std::string::npos) << read("placed.csv");
  write("bad.csv", "10,20\r\n30,40\rx,y\r");
  EXPECT_NE(run("rects bad.csv -o placed.csv").output.find("bad.csv:3: "), std::string::npos);
}

TEST_F(AtlasPack, AnEmptyListHoldsNothing) {
  for (const char* name : {"empty.json", "empty.csv"}) {
    write(name, "");
    const RunResult r = run(std::string("rects ") + name + " -o a.csv");
    EXPECT_NE(r.exit_code, 0);
    EXPECT_NE(r.output.find(std::string(name) + ": holds no rectangle"), std::string::npos)
        << r.output;
  }
}

TEST_F(AtlasPack, WrongJsonNamesItsLine) {
  write("cut.json", "[[1, 2],\n[3, 4],\n[5,");
  EXPECT_NE(run("rects cut.json -o a.csv").output.find("cut.json:3: not valid JSON"),
            std::string::npos);
  write("large.json", "[[1, 2],\n[3, 1e999]]");
  EXPECT_NE(run("rects large.json -o a.csv").output.find("large.json: holds a number beyond"),
            std::string::npos);
}

// Copying the JSON once used stack space for every level, which made the program crash.
TEST_F(AtlasPack, DeepBracketsAreNoSides) {
  const std::string open(1'000'000, '['), closed(1'000'000, ']');
  write("array.json", "[[" + open + closed + ",1]]");
  write("object.json", "[{\"width\":" + open + closed + ",\"h\":1}]");
  for (const char* name : {"array.json", "object.json"}) {
    const RunResult r = run(std::string("rects ") + name + " -o a.csv");
    EXPECT_EQ(r.exit_code, 1) << name;
    EXPECT_NE(r.output.find("element 0 has no whole sides"), std::string::npos) << r.output;
  }
}

// Opening the pipe once waited for the writer, and signals did not end that.
TEST_F(AtlasPack, APipeWithoutAWriterCanBeInterrupted) {
  ASSERT_EQ(::mkfifo((dir_ / "pipe").c_str(), 0600), 0);
  for (const char* signal : {"TERM", "HUP"}) {
    const RunResult r =
        run(fmt::format("rects pipe -o a.csv & sleep 0.5; kill -{} $!; wait $!", signal));
    EXPECT_EQ(r.exit_code, 130) << signal << r.output;
  }
  EXPECT_FALSE(fs::exists(dir_ / "a.csv"));
  const RunResult fed =
      run(fmt::format("rects pipe -o a.csv & (sleep 0.3; echo 5,6; sleep 0.3; echo 7,8) >'{}'; "
                      "wait $!",
                      (dir_ / "pipe").string()));
  EXPECT_NE(fed.output.find("2 items on 1 page"), std::string::npos) << fed.output;
}

// A list in Latin-1 once made the program fail.
TEST_F(AtlasPack, NamesNeedNotBeUtf8) {
  write("latin.csv", "caf\xe9,5,5\nb,6,6\n");
  const RunResult r = run("rects latin.csv -o out.json --preview out.svg");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  EXPECT_EQ(nlohmann::json::parse(read("out.json"))["frames"].size(), 2u);
}

// A page of 2^30 texels per side was once drawn in full before it was scaled down.
TEST_F(AtlasPack, PreviewsOfPagesOfAnySizeAreSmall) {
  write("one.csv", "5,5\n800000000,600000000\n");
  const RunResult r =
      run("rects one.csv -o out.csv --page 1073741824x1073741824 --preview out.png");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  const Result<Image8> picture = read_image8(dir_ / "out.png");
  ASSERT_TRUE(picture.ok());
  EXPECT_LE(std::max(picture->width, picture->height), 4096);
  // The item covers three quarters of the width and more than half of the height.
  const std::uint8_t *item = picture->at(picture->width / 2, picture->height / 2),
                     *free = picture->at(picture->width * 7 / 8, picture->height * 7 / 8);
  EXPECT_FALSE(std::equal(item, item + 3, free));
}

// One page fills the picture; two have a white gap between them and none behind the last.
TEST_F(AtlasPack, PreviewsAreAsWideAsTheirPages) {
  write("a.csv", "60,32\n60,32\n");
  for (const auto& [page, width, height] :
       {std::tuple("64x64", 64, 64), {"64x32", 64 + 16 + 64, 32}}) {
    ASSERT_EQ(
        run(fmt::format("rects a.csv -o a.out.csv --page {} --preview p.png", page)).exit_code, 0);
    const Result<Image8> picture = read_image8(dir_ / "p.png");
    ASSERT_TRUE(picture.ok());
    EXPECT_EQ(picture->width, width);
    EXPECT_EQ(picture->height, height);
    const std::uint8_t* corner = picture->at(picture->width - 1, 0);
    EXPECT_EQ(std::count(corner, corner + 3, 51), 3) << page;  // free space of the last page
  }
}

// Items that touch on the page differ in colour, wherever they are in the list.
TEST_F(AtlasPack, NeighboursInAPreviewDifferInColour) {
  std::string list;
  for (int i = 0; i < 400; ++i) list += fmt::format("{},{}\n", 8 + i * 7 % 23, 8 + i * 5 % 19);
  write("a.csv", list);
  ASSERT_EQ(run("rects a.csv -o a.out.csv --page 512x512 --preview p.png --crop").exit_code, 0);
  const Result<Image8> picture = read_image8(dir_ / "p.png");
  ASSERT_TRUE(picture.ok());
  struct Item {
    int x, y, w, h;
    const std::uint8_t* color;
  };
  std::vector<Item> items;
  std::istringstream lines(read("a.out.csv"));
  for (std::string line; std::getline(lines, line);) {
    Item a{};
    if (std::sscanf(line.c_str(), "%*d,0,%d,%d,%d,%d", &a.x, &a.y, &a.w, &a.h) != 4) continue;
    a.color = picture->at(a.x + a.w / 2, picture->height - 1 - (a.y + a.h / 2));
    items.push_back(a);
  }
  ASSERT_EQ(items.size(), 400u);
  int touching = 0;
  for (std::size_t i = 0; i < items.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Item &a = items[i], &b = items[j];
      if (a.x > b.x + b.w || b.x > a.x + a.w || a.y > b.y + b.h || b.y > a.y + a.h) continue;
      ++touching;
      int difference = 0;
      for (int c = 0; c < 3; ++c) difference += std::abs(a.color[c] - b.color[c]);
      EXPECT_GE(difference, 30) << i << " and " << j;
    }
  EXPECT_GT(touching, 800);
}

// All files appear together or not at all.
TEST_F(AtlasPack, APreviewThatFailsLeavesNothing) {
  std::string list;
  for (int i = 0; i < 60; ++i) list += "4,4\n";
  write("sizes.csv", list);
  {
    const FullDisk disk(3000);  // the list of places takes half of it, the preview twice as much
    const RunResult r = run("rects sizes.csv -o placed.csv --preview p.svg");
    EXPECT_EQ(r.exit_code, 1) << r.output;
    EXPECT_NE(r.output.find("p.svg"), std::string::npos) << r.output;
  }
  EXPECT_FALSE(fs::exists(dir_ / "placed.csv"));
  EXPECT_FALSE(fs::exists(dir_ / "p.svg"));
  EXPECT_EQ(run("rects sizes.csv -o placed.csv --preview p.svg").exit_code, 0);
  EXPECT_LT(fs::file_size(dir_ / "placed.csv"), 2500u);
  EXPECT_GT(fs::file_size(dir_ / "p.svg"), 3500u);
}

}  // namespace
}  // namespace atlas::test
