// The pictures that atlas-pack draws of its pages.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "libatlas/image/image_io.h"
#include "tests/apps/atlas_pack/run_pack.h"
#include "tests/support/slowness.h"

namespace atlas::test {
namespace {

bool is_free(const Image8& picture, int x, int y) {  // y down
  const std::uint8_t* texel = picture.at(x, picture.height - 1 - y);
  return texel[0] == 51 && texel[1] == 51 && texel[2] == 51;
}

// The page takes the item only upright.
TEST_F(AtlasPack, PreviewsShowTurnedItemsTurned) {
  write("l.csv", "30,10\n");
  ASSERT_EQ(run("rects l.csv -o p.csv --page 20x30 --rotate --preview p.png").exit_code, 0);
  ASSERT_NE(read("p.csv").find("0,0,0,0,10,30,1\n"), std::string::npos) << read("p.csv");
  const Result<Image8> picture = read_image8(dir_ / "p.png");
  ASSERT_TRUE(picture.ok());
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 20; ++x) EXPECT_EQ(is_free(*picture, x, y), x >= 10) << x << " " << y;
}

// Items without area may be of any length, and so may those that are not placed. Each of the high
// ones once took 15 seconds, and sums of long sides overflowed, as the preset asan tells.
TEST_F(AtlasPack, PreviewsTakeItemsOfTheLargestSides) {
  std::string list = "2147483647,0\n2147483647,1\n2147483647,2147483647\n3,4\n";
  for (int i = 0; i < 8; ++i) list += "0,2147483647\n";
  write("l.csv", list);
  const auto start = std::chrono::steady_clock::now();
  for (const char* preview : {"p.svg", "p.png"}) {
    const RunResult r = run(fmt::format("rects l.csv -o p.csv --preview {}", preview));
    EXPECT_NE(read("p.csv").find("\n3,0,"), std::string::npos) << r.output;
    EXPECT_TRUE(fs::exists(dir_ / preview)) << r.output;
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5) * kSlowness);
}

// Every item of the list is drawn at its own place on its own page; pages are 16 texels apart.
TEST_F(AtlasPack, PreviewsShowItemsOfLaterPagesAtTheirPlace) {
  write("l.csv", "12,20\n8,20\n12,20\n8,20\n");
  ASSERT_EQ(run("rects l.csv -o p.json --data array --page 20x20 --preview p.svg").exit_code, 0);
  const std::string svg = read("p.svg");
  const auto frames = nlohmann::json::parse(read("p.json"))["frames"];
  ASSERT_EQ(frames.size(), 4u);
  int later = 0;
  for (const auto& item : frames) {
    const int x = item["frame"]["x"], y = item["frame"]["y"], page = item["page"];
    later += x > 0 && page == 1;
    const std::string drawn =
        fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"20\" fill=\"#", 36 * page + x, y,
                    int(item["frame"]["w"]));
    const std::size_t at = svg.find(drawn);
    ASSERT_NE(at, std::string::npos) << drawn << "\n" << svg;
    const std::size_t title = svg.find("<title>", at);
    EXPECT_TRUE(svg.substr(title + 7).starts_with(item["filename"].get<std::string>() + "<"));
  }
  EXPECT_EQ(later, 1);
}

// With several pages, the preview once replaced the page of the same name.
TEST_F(AtlasPack, ThePreviewIsNoPage) {
  fs::create_directories(dir_ / "in");
  for (int i = 0; i < 2; ++i)
    ASSERT_TRUE(
        write_png(dir_ / fmt::format("in/{}.png", i), Image8(20, 20, 3, std::uint8_t(9 * i)), {})
            .ok());
  const auto files = [&] {
    return std::distance(fs::directory_iterator(dir_), fs::directory_iterator());
  };
  for (const char* arguments : {"--preview s.png", "--preview ./s.png",
                                "--page 20 --preview s-0.png", "--page 20 --preview ./s-1.png"}) {
    const RunResult r = run(std::string("images in -o s ") + arguments);
    EXPECT_EQ(r.exit_code, 2) << arguments << r.output;
    EXPECT_NE(r.output.find("would overwrite"), std::string::npos) << r.output;
    EXPECT_EQ(files(), 1) << arguments;
  }
  // What can be told at once is told before the images are read.
  const RunResult early = run("images absent -o s --preview s.png");
  EXPECT_NE(early.output.find("s.png: would overwrite"), std::string::npos) << early.output;
  EXPECT_EQ(run("images in -o s --page 20 --preview s-2.png").exit_code, 0);
  EXPECT_EQ(read_image8(dir_ / "s-1.png")->width, 20);
  EXPECT_EQ(read_image8(dir_ / "s-2.png")->width, 20 + 16 + 20);
}

}  // namespace
}  // namespace atlas::test
