// How atlas-pack mesh turns charts, and how large the pages are that it makes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "libatlas/core/vec.h"
#include "tests/apps/atlas_pack/run_pack.h"

namespace atlas::test {
namespace {

struct Page {
  double width = 0, height = 0;                      // as the OBJ tells them
  Vec2d low{1e9, 1e9}, high{-1e9, -1e9};             // of the uvs on it, texels
  std::vector<std::pair<Vec2d, Vec2d>> first_edges;  // of its triangles, texels
};

// Returns the pages of an OBJ by its comments, and what lies on them by its faces.
std::vector<Page> pages_of(const std::string& obj) {
  std::vector<Page> pages;
  std::vector<Vec2d> uvs;
  std::size_t on = 0;
  std::istringstream lines(obj);
  for (std::string line; std::getline(lines, line);) {
    Page page;
    Vec2d uv;
    std::size_t t[3];
    if (std::sscanf(line.c_str(), "# page_%*d: %lf x %lf texels", &page.width, &page.height) == 2)
      pages.push_back(page);
    if (std::sscanf(line.c_str(), "vt %lf %lf", &uv.x, &uv.y) == 2) uvs.push_back(uv);
    std::sscanf(line.c_str(), "usemtl page_%zu", &on);
    if (std::sscanf(line.c_str(), "f %*d/%zu %*d/%zu %*d/%zu", &t[0], &t[1], &t[2]) != 3) continue;
    Page& to = pages.at(on);
    Vec2d p[3];
    for (int k = 0; k < 3; ++k) {
      p[k] = {uvs.at(t[k] - 1).x * to.width, uvs.at(t[k] - 1).y * to.height};
      to.low = {std::min(to.low.x, p[k].x), std::min(to.low.y, p[k].y)};
      to.high = {std::max(to.high.x, p[k].x), std::max(to.high.y, p[k].y)};
    }
    to.first_edges.emplace_back(p[0], p[1]);
  }
  return pages;
}

class PackedPages : public AtlasPack {
 protected:
  // A strip ten times as long as wide, whose uvs rise by `degrees`.
  void write_strip(double degrees) const {
    const double c = std::cos(degrees * std::numbers::pi / 180),
                 s = std::sin(degrees * std::numbers::pi / 180);
    std::string text;
    for (const auto& [x, y] : {std::pair(0, 0), {10, 0}, {10, 1}, {0, 1}})
      text += fmt::format("v {} {} 0\nvt {} {}\n", x, y, c * x - s * y, s * x + c * y);
    write("m.obj", text + "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n");
  }
  // Eight right triangles of different sizes, which are eight charts.
  void write_triangles() const {
    std::string text;
    for (int k = 0; k < 8; ++k) {
      const double s = 1 + 0.2 * k;
      text += fmt::format("v {0} 0 0\nv {1} 0 0\nv {0} {2} 0\nvt {0} 0\nvt {1} 0\nvt {0} {2}\n",
                          10 * k, 10 * k + s, 2 * s);
      text += "f -3/-3 -2/-2 -1/-1\n";
    }
    write("m.obj", text);
  }
  // Rectangles of different sizes, each turned by another multiple of `degrees`.
  void write_rectangles(int count, double degrees) const {
    std::string text;
    for (int k = 0; k < count; ++k) {
      const double angle = k * degrees * std::numbers::pi / 180, c = std::cos(angle),
                   s = std::sin(angle);
      const double w = 1 + 0.1 * (k % 8), h = 1 + 0.2 * (k % 5);
      for (const auto& [x, y] : {std::pair(0., 0.), {w, 0.}, {w, h}, {0., h}})
        text += fmt::format("v {} {} 0\nvt {} {}\n", 9 * k + x, y, c * x - s * y, s * x + c * y);
      text += "f -4/-4 -3/-3 -2/-2\nf -4/-4 -2/-2 -1/-1\n";
    }
    write("m.obj", text);
  }
  std::vector<Page> packed(const std::string& options) const {
    const RunResult r = run("mesh m.obj -o out.obj -q --padding 0 " + options);
    EXPECT_EQ(r.exit_code, 0) << r.output;
    return pages_of(read("out.obj"));
  }
};

// A strip that lies askew gets straight only if any angle is allowed.
TEST_F(PackedPages, ChartsTurnByTheDirectionsAskedFor) {
  write_strip(10);
  for (const auto& [rotations, step] : {std::pair(1, 360), {2, 180}, {4, 90}}) {
    const auto pages = packed(fmt::format("--page 256 --crop --rotations {}", rotations));
    ASSERT_EQ(pages.size(), 1u);
    for (const auto& [a, b] : {pages[0].first_edges.at(0)}) {
      const double degrees = std::atan2(b.y - a.y, b.x - a.x) * 180 / std::numbers::pi;
      EXPECT_NEAR(std::remainder(degrees - 10, step), 0, 0.01) << rotations;
    }
  }
  for (const int rotations : {8, 16}) {
    const auto pages = packed(fmt::format("--page 256 --crop --rotations {}", rotations));
    ASSERT_EQ(pages.size(), 1u);
    EXPECT_NEAR(std::min(pages[0].width, pages[0].height), 26, 1) << rotations;
    EXPECT_GE(std::max(pages[0].width, pages[0].height), 255) << rotations;
  }
}

double longest_first_edge(const std::vector<Page>& pages) {
  double longest = 0;
  for (const Page& page : pages)
    for (const auto& [a, b] : page.first_edges)
      longest = std::max(longest, std::hypot(b.x - a.x, b.y - a.y));
  return longest;
}

// Charts are packed from where they lie straight, few or many, on one page or several.
TEST_F(PackedPages, ChartsThatLieAskewFillPagesAsStraightOnesDo) {
  for (const auto& [count, pages] : {std::pair(20, 1), {130, 1}, {12, 2}}) {
    const std::string options = fmt::format("--page 512 --pages {}", pages);
    write_rectangles(count, 0);
    const double straight = longest_first_edge(packed(options));
    write_rectangles(count, 31);
    EXPECT_GT(longest_first_edge(packed(options)), 0.99 * straight) << count;
  }
}

// Only the middle of this fan, which is no corner of its border, lies outside of the border.
TEST_F(PackedPages, ChartsThatFoldOverTheirBorderKeepTheirShape) {
  std::string text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv .5 .5 0\n";
  text += "vt 0 0\nvt 1 .3\nvt .7 1.3\nvt -.3 1\nvt -5 .5\n";
  for (int k = 1; k <= 4; ++k) text += fmt::format("f 5/5 {0}/{0} {1}/{1}\n", k, k % 4 + 1);
  write("m.obj", text);
  const std::vector<Page> pages = packed("--page 256");
  ASSERT_EQ(pages.size(), 1u);
  ASSERT_EQ(pages[0].first_edges.size(), 4u);
  const auto length = [&](std::size_t k) {
    const auto& [a, b] = pages[0].first_edges[k];
    return std::hypot(b.x - a.x, b.y - a.y);
  };
  EXPECT_NEAR(length(1) / length(0), std::hypot(6, .2) / std::hypot(5, .5), 1e-3);
  EXPECT_NEAR(length(2) / length(0), std::hypot(5.7, .8) / std::hypot(5, .5), 1e-3);
  EXPECT_NEAR(length(3) / length(0), std::hypot(4.7, .5) / std::hypot(5, .5), 1e-3);
}

// Triangles that lie alike fill a page less well than those that may be turned.
TEST_F(PackedPages, ChartsTurnInSomeOfTheDirectionsAskedFor) {
  write_triangles();
  for (const auto& [rotations, step] : {std::pair(1, 360), {2, 180}, {4, 90}}) {
    const auto pages = packed(fmt::format("--page 256 --rotations {}", rotations));
    ASSERT_EQ(pages.size(), 1u);
    bool turned = false;  // by a single step
    for (const auto& [a, b] : pages[0].first_edges) {
      const double degrees = std::atan2(b.y - a.y, b.x - a.x) * 180 / std::numbers::pi;
      EXPECT_NEAR(std::remainder(degrees, step), 0, 0.01) << rotations;
      turned = turned || std::abs(std::remainder(degrees, 2 * step)) > 1;
    }
    EXPECT_EQ(turned, rotations > 1) << rotations;
  }
}

TEST_F(PackedPages, EachCroppedPageEndsWhereItsChartsDo) {
  write_triangles();
  for (const auto& [options, count, border] :
       {std::tuple("--crop", 1u, 0), {"--crop --pages 3", 3u, 0}, {"--crop --border 7", 1u, 7}}) {
    const auto pages = packed(std::string("--page 256 ") + options);
    ASSERT_EQ(pages.size(), count);
    for (const Page& page : pages) {
      EXPECT_NEAR(page.low.x, border + 0.5, 0.51) << options;
      EXPECT_NEAR(page.low.y, border + 0.5, 0.51) << options;
      EXPECT_NEAR(page.high.x, page.width - border - 0.5, 0.51) << options;
      EXPECT_NEAR(page.high.y, page.height - border - 0.5, 0.51) << options;
      EXPECT_LE(std::max(page.width, page.height), 256) << options;
    }
  }
  for (const Page& page : packed("--page 256 --pages 3")) {
    EXPECT_EQ(page.width, 256);
    EXPECT_EQ(page.height, 256);
  }
}

// Only a single page of any shape is filled instead of holding the largest charts.
TEST_F(PackedPages, CroppingLeavesChartsAsLargeAsTheyAre) {
  const auto lengths = [&](const std::string& options) {
    std::multiset<int> of_edges;
    for (const Page& page : packed("--page 256 " + options))
      for (const auto& [a, b] : page.first_edges)
        of_edges.insert(int(std::lround(10 * std::hypot(b.x - a.x, b.y - a.y))));
    return of_edges;
  };
  write_triangles();
  EXPECT_EQ(lengths("--crop --pages 3"), lengths("--pages 3"));
  // Three squares leave a quarter of a square page free, and in a row all but nothing.
  std::string squares;
  for (int k = 0; k < 3; ++k) {
    for (const auto& [x, y] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}})
      squares += fmt::format("v {0} {1} 0\nvt {0} {1}\n", 3 * k + x, y);
    squares += "f -4/-4 -3/-3 -2/-2\nf -2/-2 -1/-1 -4/-4\n";
  }
  write("m.obj", squares);
  EXPECT_NEAR(*lengths("").begin(), 1280, 5);
  EXPECT_EQ(lengths("--crop --pot"), lengths(""));
  EXPECT_EQ(lengths("--crop --square"), lengths(""));
  EXPECT_LT(*lengths("--crop").rbegin(), 1270);
  const std::vector<Page> row = packed("--page 256 --crop");
  ASSERT_EQ(row.size(), 1u);
  EXPECT_LT(2.9 * std::min(row[0].width, row[0].height), std::max(row[0].width, row[0].height));
}

// The border is kept free on all sides, and the page is the smallest power of two around it.
TEST_F(PackedPages, PowersOfTwoIncludeTheBorder) {
  for (const int border : {0, 9, 40}) {
    const std::string options =
        fmt::format("--page 256 --crop --pot --rotations 1 --border {}", border);
    // The strip is a tenth as high as wide.
    const double side = (256 - 2 * border) / 10.0 + 2 * border;
    const double least = std::bit_ceil(unsigned(std::ceil(side - 1e-3)));
    write_strip(90);
    const auto upright = packed(options);
    ASSERT_EQ(upright.size(), 1u);
    EXPECT_EQ(upright[0].width, least) << border;
    EXPECT_EQ(upright[0].height, 256);
    write_strip(0);
    const auto pages = packed(options);
    ASSERT_EQ(pages.size(), 1u);
    const Page& page = pages[0];
    EXPECT_EQ(page.width, 256);
    EXPECT_EQ(page.height, least) << border;
    EXPECT_GE(std::min(page.low.x, page.low.y), border - 1e-3);
    EXPECT_LE(page.high.x, 256 - border + 1e-3);
    EXPECT_NEAR(page.high.x - page.low.x, 256 - 2 * border, 1) << border;
  }
}

// On a square page, a strip along the diagonal is longer than the sides.
TEST_F(PackedPages, SquarePagesAreFilledAsSquares) {
  write_strip(0);
  const auto length = [&](const std::string& options) {
    const auto pages = packed("--page 256 " + options);
    EXPECT_EQ(pages.size(), 1u);
    EXPECT_EQ(pages[0].width, pages[0].height) << options;
    const auto& [a, b] = pages[0].first_edges.at(0);
    return std::hypot(b.x - a.x, b.y - a.y);
  };
  EXPECT_GT(length("--square --crop"), 1.2 * 256);
  EXPECT_GT(length(""), 1.2 * 256);
  EXPECT_NEAR(length("--square --crop --rotations 1"), 256, 1);
}

// Three rows of three discs fill a square to 0.785 without gutters, if they lie in the boxes of a
// grid. A search over outlines finds less than 0.7.
TEST_F(PackedPages, EqualDiscsLieInRows) {
  constexpr int kSides = 48;
  std::string text;
  for (int k = 0; k < 9; ++k) {
    for (int i = 0; i < kSides; ++i) {
      const double a = 2 * std::numbers::pi * i / kSides;
      text += fmt::format("v {0} {1} 0\nvt {0} {1}\n", 3 * k + std::cos(a), std::sin(a));
    }
    for (int i = 2; i < kSides; ++i) {
      const int first = kSides * k + 1;
      text += fmt::format("f {0}/{0} {1}/{1} {2}/{2}\n", first, first + i - 1, first + i);
    }
  }
  write("m.obj", text);
  const RunResult r = run("mesh m.obj -o out.obj --json --padding 2 --page 512");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  const std::size_t at = r.output.find("\"utilization\":");
  ASSERT_NE(at, std::string::npos);
  EXPECT_GT(std::stod(r.output.substr(at + 14)), 0.75);
  const auto pages = pages_of(read("out.obj"));
  ASSERT_EQ(pages.size(), 1u);
  EXPECT_GE(pages[0].low.x, 0.99);
  EXPECT_GE(pages[0].low.y, 0.99);
  EXPECT_LE(pages[0].high.x, 511.01);
  EXPECT_LE(pages[0].high.y, 511.01);
}

// Overlaps are told; a mesh without them is packed without a word.
TEST_F(PackedPages, ChartsThatLieOnThemselvesAreTold) {
  // Two squares, the second one folded back onto the first, and a square alone.
  write("m.obj",
        "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\n"
        "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 5/3 4/4\nf 3/1 6/4 5/3 2/2\n");
  const RunResult r = run("mesh m.obj -o out.obj --page 64 --padding 0");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  EXPECT_NE(r.output.find("atlas-pack: charts lie on themselves, as those of tiled textures do: "
                          "all together cover 50 % of what their triangles would side by side\n"),
            std::string::npos)
      << r.output;
  const Page page = pages_of(read("out.obj")).at(0);
  EXPECT_NEAR(page.high.x - page.low.x, 64, 0.01);
  EXPECT_NEAR(page.high.y - page.low.y, 64, 0.01);
  write_triangles();
  EXPECT_EQ(run("mesh m.obj -o out.obj --page 64").output.find("lie on"), std::string::npos);
}

// What cannot be written is told before the mesh is read.
TEST_F(PackedPages, TheMaterialFileIsCheckedFirst) {
  fs::create_directories(dir_ / "out.mtl");
  for (const char* mesh : {"m.obj", "absent.obj"}) {
    write_triangles();
    const RunResult r = run(fmt::format("mesh {} -o out.obj", mesh));
    EXPECT_EQ(r.exit_code, 1) << mesh;
    EXPECT_EQ(r.output.find("atlas-pack: error: out.mtl: cannot be written"), 0u) << r.output;
    EXPECT_FALSE(fs::exists(dir_ / "out.obj"));
  }
}

}  // namespace
}  // namespace atlas::test
