// What atlas-pack reads and writes, value by value: lists, frames, previews, summaries.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/image/image_io.h"
#include "tests/apps/atlas_pack/run_pack.h"

namespace atlas::test {
namespace {

using Json = nlohmann::json;

constexpr const char* kHead = "name,page,x,y,width,height,rotated\n";

TEST_F(AtlasPack, ListsMayHaveAnySeparator) {
  for (const char* list :
       {"a,60,10\nb c,4,10\n", "a;60;10\nb c;4;10\n", "a\t60\t10\nb c\t4\t10\n",
        "\"a\", 60 ,10\nb c,4,\t10\r\n", "size of name,wide,high\na,60,10\nb c,4,10\n"}) {
    write("l.csv", list);
    const RunResult r = run("rects l.csv --page 64x32 -o p.csv");
    EXPECT_EQ(r.exit_code, 0) << list << r.output;
    EXPECT_EQ(read("p.csv"), std::string(kHead) + "a,0,0,0,60,10,0\nb c,0,60,0,4,10,0\n") << list;
  }
  write("l.txt", "a   60  10 \n  b 4 10\n");
  ASSERT_EQ(run("rects l.txt --page 64x32 -o p.csv").exit_code, 0);
  EXPECT_EQ(read("p.csv"), std::string(kHead) + "a,0,0,0,60,10,0\nb,0,60,0,4,10,0\n");
  write("l.csv", "\"say \"\"x\"\", y\",60,10\n");
  ASSERT_EQ(run("rects l.csv --page 64x32 -o p.csv").exit_code, 0);
  EXPECT_EQ(read("p.csv"), std::string(kHead) + "\"say \"\"x\"\", y\",0,0,0,60,10,0\n");
}

TEST_F(AtlasPack, LinesThatAreNoRectanglesAreToldByNumber) {
  for (const auto& [list, words] :
       {std::pair("5,5\n\n-5,5\n", "l.csv:3: a side is negative"),
        {"5,5\n5,-5\n", "l.csv:2: a side is negative"},
        {"5\n", "l.csv:1: 1 field (expected"},
        {"a,b,5,5\n", "l.csv:1: 4 fields (expected"},
        {"name,width,height\nname,width,height\n5,5\n", "l.csv:2: 'width' and 'height' are not"},
        {"5,5\nwidth,height\n", "l.csv:2: 'width' and 'height' are not two whole numbers"},
        {"5,5.5\n", "l.csv:1: '5' and '5.5' are not"}}) {
    write("l.csv", list);
    const RunResult r = run("rects l.csv -o p.csv");
    EXPECT_EQ(r.exit_code, 1) << list;
    EXPECT_TRUE(holds(r.output, words)) << r.output;
  }
}

TEST_F(AtlasPack, JsonListsMayHaveEitherNamesOfSides) {
  write("l.json",
        R"({"rects": [{"name": "a", "width": 60, "height": 10}, {"w": 4, "h": 10}, [3, 2]]})");
  const RunResult r = run("rects l.json --page 64x32 -o p.csv");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  const std::string placed = read("p.csv");
  EXPECT_TRUE(holds(placed, "a,0,0,0,60,10,0\n1,0,60,0,4,10,0\n2,0,")) << placed;
  for (const char* wrong : {"[[5, 3000000000]]", "[[3000000000, 5]]", "[[5, -1]]", "[[5]]",
                            "[[5, 5, 5]]", "[[5, 5.5]]", "[{\"w\": 5}]", "[7]"}) {
    write("w.json", wrong);
    const RunResult refused = run("rects w.json -o q.csv");
    EXPECT_EQ(refused.exit_code, 1) << wrong;
    EXPECT_TRUE(holds(refused.output, "w.json: element 0 has no whole sides")) << refused.output;
  }
  write("w.json", "{\"sizes\": []}");
  EXPECT_TRUE(
      holds(run("rects w.json -o q.csv").output, "w.json: holds no list (write an array of"));
}

// The page takes b only if it is turned, and c not at all.
TEST_F(AtlasPack, TurnedAndUnplacedItemsAreWrittenAsTheyAre) {
  write("l.csv", "a,10,10\nb,30,10\nc,31,31\n");
  const std::string command = "rects l.csv --page 20x30 --rotate --max-pages 1 ";
  const RunResult r = run(command + "-o p.csv --preview p.svg");
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_TRUE(holds(r.output, "c (31 x 31) is larger than the page")) << r.output;
  EXPECT_TRUE(holds(r.output, "p.csv, p.svg: 2 of 3 items on 1 page, 66.67 % used, ")) << r.output;
  EXPECT_TRUE(holds(r.output, "no place for 1 of 3 items (give a larger --page")) << r.output;
  const std::string placed = read("p.csv");
  const bool first = holds(placed, "a,0,10,");
  EXPECT_TRUE(holds(placed, fmt::format("b,0,{},0,10,30,1\n", first ? 0 : 10))) << placed;
  EXPECT_TRUE(holds(placed, "c,-1,,,31,31,0\n")) << placed;
  EXPECT_TRUE(holds(read("p.svg"), fmt::format("<rect x=\"{}\" y=\"0\" width=\"10\" height=\"30\"",
                                               first ? 0 : 10)))
      << read("p.svg");
  EXPECT_FALSE(holds(read("p.svg"), "<title>c<"));
  EXPECT_EQ(run(command + "-o p.json").exit_code, 1);
  const Json frames = Json::parse(read("p.json"))["frames"];
  EXPECT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames["b"]["frame"]["w"], 30) << "the size of the item before it is turned";
  EXPECT_EQ(frames["b"]["rotated"], true);
  EXPECT_EQ(frames["a"]["rotated"], false);
  const RunResult summary = run(command + "-o p.csv --json");
  const Json told = Json::parse(summary.output.substr(summary.output.find('{'))
                                    .substr(0, summary.output.find('\n', summary.output.find('{')) -
                                                   summary.output.find('{')));
  EXPECT_EQ(told["unplaced"], 1);
  EXPECT_EQ(told["items"], 3);
  EXPECT_EQ(told["pages"], Json::parse(R"([{"width":20,"height":30}])"));
  EXPECT_NEAR(double(told["utilization"]), 400.0 / 600, 1e-6);
}

TEST_F(AtlasPack, OfManyUnplacedItemsTheFirstAreNamed) {
  std::string list;
  for (int i = 0; i < 14; ++i) list += fmt::format("item{},20,20\n", i);
  write("l.csv", list);
  const RunResult r = run("rects l.csv -o p.csv --page 20x20 --max-pages 1");
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_TRUE(holds(r.output, "(20 x 20) has no room left\n")) << r.output;
  EXPECT_TRUE(holds(r.output, "and 3 more of 14 are not placed\n")) << r.output;
  const std::string quiet = run("rects l.csv -o p.csv --page 20x20 --max-pages 1 -q").output;
  EXPECT_TRUE(holds(quiet, "and 3 more of 14 are not placed\n")) << quiet;
  EXPECT_TRUE(holds(quiet,
                    "atlas-pack: error: no place for 13 of 14 items (give a larger --page or more "
                    "--max-pages)\n"))
      << quiet;
}

TEST_F(AtlasPack, NamesThatAJsonObjectCannotHoldTwiceMayStandInOtherOutputs) {
  write("l.csv", "a,4,5\na,6,7\n");
  EXPECT_EQ(run("rects l.csv -o p.csv").exit_code, 0);
  EXPECT_EQ(run("rects l.csv -o p.json --data array").exit_code, 0);
  EXPECT_EQ(Json::parse(read("p.json"))["frames"].size(), 2u);
  EXPECT_EQ(run("rects l.csv -o q.json").exit_code, 1);
}

TEST_F(AtlasPack, DataOfSeveralPagesSayThePageOfEachItem) {
  write("l.csv", "a,20,20\nb,20,20\nc,20,20\n");
  ASSERT_EQ(run("rects l.csv -o p.json --page 20x20").exit_code, 0);
  const Json all = Json::parse(read("p.json"));
  std::vector<int> pages{all["frames"]["a"]["page"], all["frames"]["b"]["page"],
                         all["frames"]["c"]["page"]};
  std::sort(pages.begin(), pages.end());
  EXPECT_EQ(pages, (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(all["meta"]["pages"], Json::parse(R"([{"w":20,"h":20},{"w":20,"h":20},
                                                  {"w":20,"h":20}])"));
}

// Pages lie side by side with gaps of 16 texels, and y points down.
TEST_F(AtlasPack, PreviewsShowItemsWhereTheyAre) {
  write("l.csv", "\"<&\"\">\",20,10\nb,20,30\n");
  ASSERT_EQ(run("rects l.csv -o p.csv --page 20x30 --preview p.svg").exit_code, 0);
  const std::string svg = read("p.svg");
  EXPECT_TRUE(holds(svg, "viewBox=\"0 0 56 30\"")) << svg;
  EXPECT_TRUE(holds(svg, "<title>&lt;&amp;&quot;&gt;</title>")) << svg;
  EXPECT_TRUE(holds(svg, "width=\"20\" height=\"10\" fill=\"#")) << svg;
  ASSERT_EQ(run("rects l.csv -o p.csv --page 20x30 --preview p.png").exit_code, 0);
  const Result<Image8> picture = read_image8(dir_ / "p.png");
  ASSERT_TRUE(picture.ok());
  const std::string placed = read("p.csv");
  const int left = holds(placed, "\",0,0,") ? 0 : 36;  // of the page with the low item
  const auto free = [&](int x, int y) {                // y down
    const std::uint8_t* texel = picture->at(left + x, picture->height - 1 - y);
    return texel[0] == 51 && texel[1] == 51 && texel[2] == 51;
  };
  ASSERT_TRUE(holds(placed, ",0,0,20,10,0\n")) << placed;
  EXPECT_FALSE(free(0, 0) || free(19, 9));
  EXPECT_TRUE(free(0, 10) && free(19, 29));
  EXPECT_EQ(run("rects l.csv -o p.csv --preview l.csv").exit_code, 2);
  write("l.svg", "5,5\n");
  EXPECT_EQ(run("rects l.svg -o p.csv --preview l.svg").exit_code, 2);
  EXPECT_EQ(read("l.svg"), "5,5\n");
}

// Grey and grey with alpha become colours; borders up to the threshold are cut.
TEST_F(AtlasPack, SpritesOfAnyKindAreCutToWhatIsSeen) {
  fs::create_directories(dir_ / "in/sub");
  Image8 grey(4, 3, 1, 77);
  Image8 seen(9, 8, 2, 0);  // seen in 3..5 x 1..6, counted from below
  for (int y = 1; y <= 6; ++y)
    for (int x = 3; x <= 5; ++x) seen.at(x, y)[0] = 200, seen.at(x, y)[1] = 10;
  seen.at(4, 3)[1] = 200;
  ASSERT_TRUE(write_png(dir_ / "in/grey.png", grey, {}).ok());
  ASSERT_TRUE(write_png(dir_ / "in/sub/seen.png", seen, {}).ok());
  ASSERT_TRUE(write_png(dir_ / "in/none.png", Image8(5, 6, 4, 0), {}).ok());
  write("in/notes.txt", "");
  const auto frames = [&](const std::string& more) {
    const RunResult r = run("images in -o s --page 64 " + more);
    EXPECT_EQ(r.exit_code, 0) << r.output;
    EXPECT_TRUE(holds(r.output, "in/notes.txt: left out, no image by its ending")) << r.output;
    return Json::parse(read("s.json"))["frames"];
  };
  const Json cut = frames("");
  ASSERT_EQ(cut.size(), 3u);
  const Json& s = cut["sub/seen.png"];
  EXPECT_EQ(s["spriteSourceSize"], Json::parse(R"({"x":3,"y":1,"w":3,"h":6})"));
  EXPECT_EQ(s["sourceSize"], Json::parse(R"({"w":9,"h":8})"));
  EXPECT_EQ(s["trimmed"], true);
  EXPECT_EQ(cut["grey.png"]["trimmed"], false);
  EXPECT_EQ(cut["none.png"]["frame"]["w"], 1);
  EXPECT_EQ(cut["none.png"]["spriteSourceSize"], Json::parse(R"({"x":0,"y":0,"w":1,"h":1})"));
  const auto page = read_image8(dir_ / "s.png");
  ASSERT_TRUE(page.ok());
  const Json& g = cut["grey.png"]["frame"];
  const std::uint8_t* texel = page->at(g["x"], page->height - 1 - int(g["y"]));
  EXPECT_EQ(std::vector<int>(texel, texel + 4), (std::vector<int>{77, 77, 77, 255}));
  texel = page->at(s["frame"]["x"], page->height - 1 - int(s["frame"]["y"]));
  EXPECT_EQ(std::vector<int>(texel, texel + 4), (std::vector<int>{200, 200, 200, 10}));
  EXPECT_EQ(frames("--trim-threshold 9")["sub/seen.png"]["frame"]["h"], 6);
  EXPECT_EQ(frames("--trim-threshold 10")["sub/seen.png"]["frame"]["h"], 1);
  EXPECT_EQ(frames("--no-trim")["sub/seen.png"]["frame"]["h"], 8);
}

// Bytes that are not UTF-8 are replaced in JSON, where two names could become one.
TEST_F(AtlasPack, NamesThatJsonCannotTellApartAreRefused) {
  fs::create_directories(dir_ / "in");
  ASSERT_TRUE(write_png(dir_ / "in/b\xe9.png", Image8(4, 4, 3, 9), {}).ok());
  EXPECT_EQ(run("images in -o s").exit_code, 0);
  ASSERT_TRUE(write_png(dir_ / "in/b\xe8.png", Image8(5, 5, 3, 9), {}).ok());
  const RunResult images = run("images in -o s");
  EXPECT_EQ(images.exit_code, 1);
  EXPECT_TRUE(holds(images.output, "its name is not UTF-8, and another image")) << images.output;
  write("bytes.csv", "b\xe9,3,4\nb\xe8,3,4\n");
  EXPECT_EQ(run("rects bytes.csv -o q.csv").exit_code, 0);
  const RunResult rects = run("rects bytes.csv -o q.json");
  EXPECT_EQ(rects.exit_code, 1);
  EXPECT_TRUE(holds(rects.output, "two items are called")) << rects.output;
}

// The Finder keeps attributes of a file on foreign disks in a second one, which is no image.
TEST_F(AtlasPack, CompanionFilesOfMacOsAreLeftOut) {
  fs::create_directories(dir_ / "in");
  ASSERT_TRUE(write_png(dir_ / "in/a.png", Image8(4, 4, 3, 9), {}).ok());
  write("in/._a.png", "attributes");
  const RunResult r = run("images in -o s");
  EXPECT_EQ(r.exit_code, 0) << r.output;
  EXPECT_TRUE(holds(r.output, "in/._a.png: left out, what macOS keeps beside a file")) << r.output;
  EXPECT_EQ(Json::parse(read("s.json"))["frames"].size(), 1u);
}

TEST_F(AtlasPack, SpritesOfOneLookAreStoredOnceAndPagesHoldTheirOwn) {
  fs::create_directories(dir_ / "in");
  for (const auto& [name, level] : {std::pair("c", 9), {"b", 9}, {"a", 40}})
    ASSERT_TRUE(
        write_png(dir_ / fmt::format("in/{}.png", name), Image8(20, 20, 3, std::uint8_t(level)), {})
            .ok());
  const RunResult r = run("images in -o s --page 20x20");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  EXPECT_TRUE(holds(r.output, ": 3 items on 2 pages, 100.00 % used, 1 sharing another's place, "))
      << r.output;
  const Json first = Json::parse(read("s-0.json")), second = Json::parse(read("s-1.json"));
  EXPECT_EQ(first["frames"].size() + second["frames"].size(), 3u);
  EXPECT_EQ(first["meta"]["image"], "s-0.png");
  EXPECT_EQ(second["meta"]["image"], "s-1.png");
  EXPECT_EQ(second["meta"]["size"], Json::parse(R"({"w":20,"h":20})"));
  const RunResult each = run("images in -o s --page 20x20 --no-alias");
  EXPECT_TRUE(holds(each.output, ": 3 items on 3 pages, 100.00 % used, 0.")) << each.output;
  const std::string output = run("images in -o s --page 20x20 --json").output;
  EXPECT_EQ(Json::parse(output.substr(output.find('{')))["aliases"], 1) << output;
  const RunResult full = run("images in -o t --page 20x20 --max-pages 1");
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_TRUE(holds(full.output, "in: 1 of 3 images have no room, first ")) << full.output;
  EXPECT_FALSE(fs::exists(dir_ / "t.png"));
  // Repeated edge texels need room, too.
  EXPECT_EQ(run("images in -o t --page 22x22 --extrude 1").exit_code, 0);
  EXPECT_EQ(run("images in -o t --page 22x21 --extrude 1").exit_code, 1);
}

}  // namespace
}  // namespace atlas::test
