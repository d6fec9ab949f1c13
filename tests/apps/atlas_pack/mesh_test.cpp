// Tests atlas-pack mesh, which packs the charts of a mesh's own uvs.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/apps/atlas_pack/run_pack.h"

namespace atlas::test {
namespace {

// Returns the uv area of every face of an OBJ file of triangles, times two.
std::vector<double> uv_areas(const std::string& obj) {
  std::vector<std::pair<double, double>> vt;
  std::vector<double> areas;
  std::istringstream lines(obj);
  for (std::string line; std::getline(lines, line);) {
    double u = 0, v = 0;
    std::size_t t[3];
    if (std::sscanf(line.c_str(), "vt %lf %lf", &u, &v) == 2) vt.emplace_back(u, v);
    if (std::sscanf(line.c_str(), "f %*d/%zu %*d/%zu %*d/%zu", &t[0], &t[1], &t[2]) != 3) continue;
    const auto a = vt.at(t[0] - 1), b = vt.at(t[1] - 1), c = vt.at(t[2] - 1);
    areas.push_back(std::abs((b.first - a.first) * (c.second - a.second) -
                             (b.second - a.second) * (c.first - a.first)));
  }
  return areas;
}

// Two unit squares whose uvs differ in size by a factor of ten.
constexpr const char* kUnequalSquares =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0 0\nvt 0.1 0\nvt 0.1 0.1\nvt 0 0.1\n"
    "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\nf 5/5 6/6 7/7\nf 5/5 7/7 8/8\n";

TEST_F(AtlasPack, MeshChartsAtUniformDensity) {
  write("m.obj", kUnequalSquares);
  const RunResult r = run("mesh m.obj --page 128 --padding 2 -o out.obj --preview p.png");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  EXPECT_TRUE(fs::exists(dir_ / "p.png"));
  const std::vector<double> areas = uv_areas(read("out.obj"));
  ASSERT_EQ(areas.size(), 4u);
  for (const double area : areas) EXPECT_NEAR(area, areas[0], 1e-6);
  EXPECT_GT(areas[0], 0.1);
}

// The larger square nearly fills the page: 1 / 1.1 of its side, less the padding.
TEST_F(AtlasPack, MeshChartsKeepTheDensityThatTheyHave) {
  write("m.obj", kUnequalSquares);
  const RunResult r = run("mesh m.obj --page 128 --padding 2 --keep-density -o out.obj");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  const std::vector<double> areas = uv_areas(read("out.obj"));
  ASSERT_EQ(areas.size(), 4u);
  for (const std::size_t square : {0, 2}) EXPECT_NEAR(areas[square], areas[square + 1], 1e-6);
  EXPECT_NEAR(areas[0] / areas[2], 100, 0.01);
  EXPECT_GT(areas[0], 0.75);
}

// A square on a page four times as wide as high has uvs a quarter as wide as high. Its shape is
// known from --uv-aspect, or from what the file says of its page.
TEST_F(AtlasPack, MeshUvsOfAPageThatIsNotSquare) {
  const std::string square =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 0.25 0\nvt 0.25 1\nvt 0 1\n"
      "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";
  write("plain.obj", square);
  write("told.obj", "# name\n# uvs of a page of 2048 x 512 texels: textures\n" + square);
  const auto sides = [&](const std::string& arguments) {
    const RunResult r = run("mesh " + arguments + " --page 100 --padding 0 --crop -o out.obj");
    EXPECT_EQ(r.exit_code, 0) << r.output;
    std::string line;
    for (std::istringstream lines(read("out.obj")); std::getline(lines, line);)
      if (line.starts_with("# page_0: ")) return line;
    return std::string();
  };
  EXPECT_EQ(sides("plain.obj --uv-aspect 4"), "# page_0: 100 x 100 texels");
  EXPECT_EQ(sides("told.obj"), "# page_0: 100 x 100 texels");
  EXPECT_EQ(sides("plain.obj"), "# page_0: 100 x 25 texels");
  EXPECT_EQ(sides("told.obj --uv-aspect 1"), "# page_0: 100 x 25 texels");
  // What was written is read again with its shape.
  ASSERT_EQ(run("mesh out.obj --page 100 --padding 0 --crop -o again.obj").exit_code, 0);
  EXPECT_NE(read("again.obj").find("# page_0: 100 x 25 texels"), std::string::npos);
}

TEST_F(AtlasPack, ATextureCoordinateFarFromTheOthersIsNamed) {
  const std::string mesh =
      "# a plate\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\n  vt {} 0.5\nvt 0 1\n"
      "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";
  write("far.obj", fmt::format(fmt::runtime(mesh), "1e30"));
  const RunResult r = run("mesh far.obj -o out.obj");
  EXPECT_EQ(r.exit_code, 1) << r.output;
  EXPECT_NE(r.output.find("far.obj: line 8: vt 3, (1e+30, 0.5) is a texture coordinate so far"),
            std::string::npos)
      << r.output;
  EXPECT_FALSE(fs::exists(dir_ / "out.obj"));
  // The page's shape changes the coordinates in memory, but not those in the message.
  EXPECT_NE(run("mesh far.obj --uv-aspect 4 -o out.obj").output.find("vt 3, (1e+30, 0.5) is"),
            std::string::npos);
  write("near.obj", fmt::format(fmt::runtime(mesh), "1.5"));
  EXPECT_EQ(run("mesh near.obj -o out.obj").exit_code, 0);
}

// Positions are floats, so the written numbers are no longer than those read. -0 becomes 0.
TEST_F(AtlasPack, MeshPositionsAreWrittenAsRead) {
  write("m.obj", "v 0.05 -0 0\nv 1.1 0 0\nv 0.05 0.3 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
  const RunResult r = run("mesh m.obj -o out.obj");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  const std::string text = read("out.obj");
  EXPECT_NE(text.find("v 0.05 0 0\nv 1.1 0 0\nv 0.05 0.3 0\n"), std::string::npos) << text;
}

// Uvs of tiles overlap. The area that they cover fills the page, and overlaps are counted once.
TEST_F(AtlasPack, MeshChartsThatLieOnThemselvesFillThePage) {
  std::string text = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
  for (int k = 0; k < 10; ++k) {  // a strip in which every other square is mirrored
    text += fmt::format("v {0} 0 0\nv {0} 1 0\n", k);
    if (k == 0) continue;
    const int v = 2 * k - 1, left = k % 2 ? 1 : 2, right = 3 - left;
    text += fmt::format("f {0}/{4} {2}/{5} {3}/{6}\nf {0}/{4} {3}/{6} {1}/{7}\n", v, v + 1, v + 2,
                        v + 3, left, right, 5 - right, 5 - left);
  }
  write("strip.obj", text);
  const RunResult r = run("mesh strip.obj --page 256 --padding 0 -o out.obj --json");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  const auto json = nlohmann::json::parse(r.output.substr(r.output.find('{')));
  EXPECT_EQ(json["items"], 1);
  EXPECT_GT(json["utilization"], 0.9);
  EXPECT_LE(json["utilization"], 1.0);
}

// A thousand squares, each of which is a chart.
TEST_F(AtlasPack, ChartsThatDoNotFitAreToldWithWhatHelps) {
  std::string text = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n", faces;
  for (int i = 0; i < 1000; ++i) {
    text += fmt::format("v {0} 0 0\nv {1} 0 0\nv {1} 1 0\nv {0} 1 0\n", 2 * i, 2 * i + 1);
    text += fmt::format("vt {0} 0\nvt {1} 0\nvt {1} 1\nvt {0} 1\n", 2 * i + 2, 2 * i + 3);
    const int v = 4 * i + 1, t = v + 4;
    faces += fmt::format("f {0}/{4} {1}/{5} {2}/{6}\nf {0}/{4} {2}/{6} {3}/{7}\n", v, v + 1, v + 2,
                         v + 3, t, t + 1, t + 2, t + 3);
  }
  write("many.obj", text + faces);
  const std::string words =
      "many.obj: its 1000 charts do not fit 1 page of 16 x 16 texels even as "
      "small as can be (give a larger --page";
  const RunResult plain = run("mesh many.obj -o out.obj --page 16");
  EXPECT_EQ(plain.exit_code, 1);
  EXPECT_NE(plain.output.find(words + " or more --pages)"), std::string::npos) << plain.output;
  const RunResult padded = run("mesh many.obj -o out.obj --page 16 --padding 2");
  EXPECT_NE(padded.output.find(words + ", more --pages or a smaller --padding)"), std::string::npos)
      << padded.output;
}

// Returns eight right triangles that are far apart in their own uvs.
std::string triangles_obj() {
  std::string text;
  for (int k = 0; k < 8; ++k) {
    const double s = 1 + 0.2 * k;
    text += fmt::format("v {0} 0 0\nv {1} 0 0\nv {0} {2} 0\n", 10 * k, 10 * k + s, 2 * s);
    text += fmt::format("vt {0} 0\nvt {1} 0\nvt {0} {2}\n", 10 * k, 10 * k + s, 2 * s);
  }
  for (int k = 0; k < 8; ++k)
    text += fmt::format("f {0}/{0} {1}/{1} {2}/{2}\n", 3 * k + 1, 3 * k + 2, 3 * k + 3);
  return text;
}

// Two squares of two triangles each, in which every corner has its own vt. They are still two
// charts.
TEST_F(AtlasPack, MeshChartsAreFoundByPlaceAndValueAndStayCharts) {
  write("m.obj",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 5\nv 1 0 5\nv 1 1 5\nv 0 1 5\n"
        "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 0\nvt 1 1\nvt 0 1\n"
        "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 0\nvt 1 1\nvt 0 1\n"
        "f 1/1 2/2 3/3\nf 1/4 3/5 4/6\nf 5/7 6/8 7/9\nf 5/10 7/11 8/12\n");
  for (const char* names : {"m.obj -o out.obj", "out.obj -o again.obj"}) {
    const RunResult r = run(fmt::format("mesh {} --page 64 --pages 2", names));
    ASSERT_EQ(r.exit_code, 0) << r.output;
    EXPECT_NE(r.output.find(": 2 items"), std::string::npos) << r.output;
    EXPECT_EQ(r.output.find("defect"), std::string::npos) << r.output;
  }
  const std::string obj = read("again.obj"), mtl = read("again.mtl");
  std::istringstream lines(obj);
  int vts = 0;
  for (std::string line; std::getline(lines, line);) {
    vts += line.starts_with("vt ");
    EXPECT_EQ(line.find('-'), line[0] == '#' ? line.find('-') : std::string::npos) << line;
    if (line.starts_with("usemtl ")) {
      EXPECT_NE(mtl.find("newmtl " + line.substr(7) + "\n"), std::string::npos) << line;
    }
  }
  EXPECT_EQ(vts, 8);
  // A material file that the input uses must stay.
  write("mine.mtl", "newmtl red\n");
  write("other.obj", "mtllib mine.mtl\n" + read("m.obj"));
  const RunResult over = run("mesh other.obj -o mine.obj");
  EXPECT_EQ(over.exit_code, 2) << over.output;
  EXPECT_EQ(read("mine.mtl"), "newmtl red\n");
}

// Two objects, each with a chart on either page. Every corner keeps its normal and its object, and
// what a face of the result shows is compared with the face of the same corners in the input.
TEST_F(AtlasPack, MeshKeepsObjectsAndNormalsAndTellsWhatItDoesNotKeep) {
  write("m.mtl", "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n");
  std::string text = "mtllib m.mtl\nvn 0 0 1\nvn 0.6 0 0.8\n";
  for (int k = 0; k < 4; ++k)
    text += fmt::format("v {0} 0 0\nv {1} 0 0\nv {0} 1 0\nvt {0} 0\nvt {1} 0\nvt {0} 1\n", 10 * k,
                        10 * k + 1);
  const auto face = [](int k) {
    return fmt::format("f {0}/{0}/1 {1}/{1}/2 {2}/{2}/1\n", 3 * k + 1, 3 * k + 2, 3 * k + 3);
  };
  text += "o left wing\nusemtl red\n" + face(0) + face(1) + "o hull\nusemtl blue\n" + face(2);
  write("m.obj", text + face(3) + "f 1//2 5//1 9//1\nf 1 6 9\n");
  const RunResult r = run("mesh m.obj --page 64 --pages 2 -o out.obj");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  EXPECT_NE(r.output.find("not kept: 2 x materials (there is one a page instead)"),
            std::string::npos)
      << r.output;
  std::istringstream lines(read("out.obj"));
  std::string object;
  std::map<std::string, int> faces;  // "object: points, normals"
  std::vector<std::string> normals;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("o ")) object = line.substr(2);
    if (line.starts_with("vn ")) normals.push_back(line);
    int v[3], vt[3], n[3];
    if (std::sscanf(line.c_str(), "f %d/%d/%d %d/%d/%d %d/%d/%d", &v[0], &vt[0], &n[0], &v[1],
                    &vt[1], &n[1], &v[2], &vt[2], &n[2]) == 9 ||
        std::sscanf(line.c_str(), "f %d//%d %d//%d %d//%d", &v[0], &n[0], &v[1], &n[1], &v[2],
                    &n[2]) == 6)
      ++faces[fmt::format("{}: {} {} {}, {} {} {}", object, v[0], v[1], v[2], n[0], n[1], n[2])];
    else if (line.starts_with("f "))
      ++faces[object + ": " + line];
  }
  EXPECT_EQ(normals, (std::vector<std::string>{"vn 0 0 1", "vn 0.6 0 0.8"}));
  const std::map<std::string, int> wanted{
      {"left wing: 1 2 3, 1 2 1", 1}, {"left wing: 4 5 6, 1 2 1", 1}, {"hull: 7 8 9, 1 2 1", 1},
      {"hull: 10 11 12, 1 2 1", 1},   {"hull: 1 5 9, 2 1 1", 1},      {"hull: f 1 6 9", 1}};
  EXPECT_EQ(faces, wanted);
  // The result has no materials but those of its pages.
  write("plain.obj", triangles_obj());
  EXPECT_EQ(run("mesh plain.obj -o out.obj").output.find("not kept"), std::string::npos);
}

// A square that fills its page reaches its corners, and one with a gutter ends at a whole texel.
TEST_F(AtlasPack, MeshUvsEndWhereChartsDo) {
  write("m.obj",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
        "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n");
  for (const int padding : {0, 2}) {
    ASSERT_EQ(run(fmt::format("mesh m.obj --page 256 --padding {} -o out.obj", padding)).exit_code,
              0);
    const std::string low = padding ? "0.00390625" : "0", high = padding ? "0.99609375" : "1";
    std::istringstream lines(read("out.obj"));
    std::set<std::string> uvs;
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with("vt ")) uvs.insert(line.substr(3));
    EXPECT_EQ(uvs, (std::set<std::string>{low + " " + low, low + " " + high, high + " " + low,
                                          high + " " + high}));
  }
}

TEST_F(AtlasPack, MeshOptionsDoWhatTheySay) {
  write("t.obj", triangles_obj());
  const auto pages = [&](const std::string& more) {
    const RunResult r = run("mesh t.obj -o out.obj --json --page 256 " + more);
    EXPECT_EQ(r.exit_code, 0) << r.output;
    return nlohmann::json::parse(r.output);
  };
  const auto whole = pages("");
  EXPECT_EQ(whole["pages"][0]["width"], 256);
  EXPECT_EQ(whole["pages"][0]["height"], 256);
  const auto cropped = pages("--crop");
  EXPECT_LE(cropped["pages"][0]["width"], 256);
  EXPECT_LE(cropped["pages"][0]["height"], 256);
  EXPECT_GE(double(cropped["utilization"]), double(whole["utilization"]));
  EXPECT_NE(read("out.obj").find(fmt::format("# page_0: {} x {} texels\n",
                                             int(cropped["pages"][0]["width"]),
                                             int(cropped["pages"][0]["height"]))),
            std::string::npos);
  const auto square = pages("--crop --square");
  EXPECT_EQ(square["pages"][0]["width"], square["pages"][0]["height"]);
  // The result of `best` depends only on seed and effort.
  pages("--preset best --effort 100 --seed 3 --threads 1");
  const std::string first = read("out.obj");
  pages("--preset best --effort 100 --seed 3 --threads 2");
  EXPECT_EQ(read("out.obj"), first);
  // The border stays free.
  pages("--border 20");
  std::istringstream lines(read("out.obj"));
  for (std::string line; std::getline(lines, line);) {
    double u = 0, v = 0;
    if (std::sscanf(line.c_str(), "vt %lf %lf", &u, &v) != 2) continue;
    for (double x : {u * 256, v * 256}) {
      EXPECT_GE(x, 20 - 1e-6);
      EXPECT_LE(x, 236 + 1e-6);
    }
  }
  pages("--preview p.svg");
  EXPECT_NE(read("p.svg").find("<path"), std::string::npos);
  EXPECT_EQ(run("mesh t.obj -o out.obj --preview p.gif").exit_code, 2);
  const RunResult full = run("mesh t.obj -o out.obj --page 64 --padding 40");
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_NE(full.output.find("a larger --page, more --pages or a smaller --padding"),
            std::string::npos)
      << full.output;
  // Not accepted for meshes, whose charts get square pages.
  EXPECT_EQ(run("mesh t.obj -o out.obj --max-width 99").exit_code, 2);
}

}  // namespace
}  // namespace atlas::test
