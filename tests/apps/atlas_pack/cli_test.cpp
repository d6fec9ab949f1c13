// atlas-pack as its users meet it: files in, files out, exit codes and messages.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "libatlas/image/image_io.h"

namespace {

namespace fs = std::filesystem;

struct RunResult {
  int exit_code = -1;
  std::string output;
};

class AtlasPack : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    dir_ = fs::temp_directory_path() / fmt::format("atlas_pack_{}_{}", info->name(), ::getpid());
    fs::create_directories(dir_);
  }
  void TearDown() override { fs::remove_all(dir_); }

  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(dir_ / name, std::ios::binary) << text;
    return dir_ / name;
  }
  std::string read(const std::string& name) const {
    std::stringstream text;
    text << std::ifstream(dir_ / name).rdbuf();
    return text.str();
  }
  RunResult run(const std::string& arguments) const {
    RunResult result;
    const std::string command =
        fmt::format("cd '{}' && '{}' {} 2>&1", dir_.string(), ATLAS_PACK, arguments);
    FILE* pipe = ::popen(command.c_str(), "r");
    char buffer[4096];
    while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe))
      result.output.append(buffer, n);
    const int status = ::pclose(pipe);
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
    return result;
  }
  fs::path dir_;
};

TEST_F(AtlasPack, RectsFromCsvToCsv) {
  write("sizes.csv", "name,width,height\na,60,10\n\"b,c\",4,10\n");
  const RunResult r = run("rects sizes.csv --page 64x32 -o placed.csv --preview p.svg");
  EXPECT_EQ(r.exit_code, 0) << r.output;
  EXPECT_EQ(read("placed.csv"),
            "name,page,x,y,width,height,rotated\na,0,0,0,60,10,0\n\"b,c\",0,60,0,4,10,0\n");
  EXPECT_NE(read("p.svg").find("<svg"), std::string::npos);
}

// Published instances begin with `width height count`; --page has the last word.
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
  write("named.txt", "1 10 3\n2 10 4\n");  // all are named: a list
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

// Blocks of compressed texels are counted from the upper edge, whatever the page's height.
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
  EXPECT_NE(read("q.csv").find("1,0,"), std::string::npos);  // the other one is placed
}

// One line that contains the words, and no file.
TEST_F(AtlasPack, WhatCannotBeDoneLeavesNothing) {
  fs::create_directories(dir_ / "folder");
  write("ok.csv", "a,4,5\nb,6,7\n");
  write("empty.csv", "");
  write("twice.csv", "a,4,5\na,6,7\n");
  write("header.csv", "name,width,height\n");
  write("short.csv", "a,4\nb,6,7\n");  // no header: it has a number
  write("huge.csv", "a,99999999999,5\n");
  write("cut.json", "[[4,5],[6");
  write("uv.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
  write("plain.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::pair<const char*, const char*> cases[] = {
      {"rects folder -o q.csv", "is a directory"},
      {"rects empty.csv -o q.csv", "no rectangle"},
      {"rects ok.csv/in.csv -o q.csv", "cannot be read: Not a directory"},
      {"rects twice.csv -o q.json", "two items are called 'a'"},
      {"rects header.csv -o q.csv", "no rectangle"},
      {"rects short.csv -o q.csv", "short.csv:1"},
      {"rects huge.csv -o q.csv", "huge.csv:1"},
      {"rects cut.json -o q.csv", "cut.json"},
      {"rects ok.csv -o ./ok.csv", "would overwrite"},
      {"rects ok.csv -o q.txt", ".csv or .json"},
      {"rects ok.csv -o no/q.csv", "no is not a directory"},
      {"rects ok.csv -o q.csv --preview p.gif", ".svg or .png"},
      {"rects ok.csv -o q.csv --preview no/p.svg", "no is not a directory"},
      {"rects ok.csv -o q.csv --page 99999999999", "--page"},
      {"rects ok.csv -o q.csv --page 0x512", "--page"},  // no hexadecimal number
      {"rects ok.csv -o q.csv --page 1e2", "--page"},
      {"rects ok.csv -o q.csv --threads -1", "--threads"},
      {"rects ok.csv -o q.csv --effort -1", "--effort"},
      {"rects ok.csv -o q.csv --padding -1", "--padding"},
      {"rects ok.csv -o q.csv --align 0", "--align"},
      {"rects ok.csv -o q.csv --preset good", "one of best, default, fast"},
      {"images folder -o q", "no image"},
      {"images ok.csv -o q", "no folder"},
      {"images folder -o folder/q", "in the folder that is read"},
      {"mesh uv.obj -o uv.obj", "would overwrite"},
      {"mesh uv.obj -o q.stl", "must end in .obj"},
      {"mesh uv.obj -o q.obj --rotations 3", "--rotations"},
      {"mesh plain.obj -o q.obj", "plain.obj: has no uvs"},
      {"mesh folder -o q.obj", "is a directory"},
      {"", "a command is needed"},
  };
  const auto files = [&] {
    return std::distance(fs::directory_iterator(dir_), fs::directory_iterator());
  };
  const auto before = files();
  for (const auto& [arguments, words] : cases) {
    const RunResult r = run(arguments);
    EXPECT_TRUE(r.exit_code == 1 || r.exit_code == 2) << arguments << "\n" << r.output;
    EXPECT_EQ(std::count(r.output.begin(), r.output.end(), '\n'), 1) << r.output;
    EXPECT_EQ(r.output.rfind("atlas-pack: error: ", 0), 0u) << r.output;
    EXPECT_NE(r.output.find(words), std::string::npos) << arguments << "\n" << r.output;
    EXPECT_EQ(files(), before) << arguments;
  }
  EXPECT_EQ(read("ok.csv"), "a,4,5\nb,6,7\n");
}

TEST_F(AtlasPack, SpritesKeepTheirTexels) {
  fs::create_directories(dir_ / "in/sub");
  const auto sprite = [](int w, int h, int border, int tint) {
    atlas::Image8 image(w, h, 4);
    for (int y = border; y < h - border; ++y)
      for (int x = border; x < w - border; ++x) {
        std::uint8_t* t = image.at(x, y);
        t[0] = static_cast<std::uint8_t>(x * 7);
        t[1] = static_cast<std::uint8_t>(y * 5);
        t[2] = static_cast<std::uint8_t>(tint);
        t[3] = 255;
      }
    return image;
  };
  const atlas::Image8 a = sprite(20, 12, 3, 10), c = sprite(6, 30, 0, 90);
  ASSERT_TRUE(atlas::write_png(dir_ / "in/a.png", a, {}).ok());
  ASSERT_TRUE(atlas::write_png(dir_ / "in/b.png", a, {}).ok());
  ASSERT_TRUE(atlas::write_png(dir_ / "in/sub/c.png", c, {}).ok());
  const RunResult r = run("images in -o sheet --page 48x24 --rotate --extrude 1 --padding 1");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  const auto page = atlas::read_image8(dir_ / "sheet.png");
  ASSERT_TRUE(page.ok());
  const auto frames = nlohmann::json::parse(read("sheet.json"))["frames"];
  EXPECT_EQ(frames["a.png"]["frame"], frames["b.png"]["frame"]);  // identical images share
  for (const auto& [name, image] : {std::pair("a.png", &a), {"sub/c.png", &c}}) {
    const auto& f = frames[name];
    const int w = f["frame"]["w"], h = f["frame"]["h"];
    const int ox = f["spriteSourceSize"]["x"], oy = f["spriteSourceSize"]["y"];
    EXPECT_EQ(f["sourceSize"]["w"], image->width);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        // Read back as a game does: y down, clockwise if rotated.
        const bool turned = f["rotated"];
        const int px = int(f["frame"]["x"]) + (turned ? h - 1 - y : x);
        const int py = int(f["frame"]["y"]) + (turned ? x : y);
        const std::uint8_t* got = page->at(px, page->height - 1 - py);
        const std::uint8_t* expected = image->at(ox + x, image->height - 1 - (oy + y));
        ASSERT_TRUE(std::equal(got, got + 4, expected)) << name << " " << x << " " << y;
      }
  }
}

TEST_F(AtlasPack, MeshChartsAtUniformDensity) {
  // Two unit squares whose uvs differ in size tenfold.
  write("m.obj",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
        "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0 0\nvt 0.1 0\nvt 0.1 0.1\nvt 0 0.1\n"
        "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\nf 5/5 6/6 7/7\nf 5/5 7/7 8/8\n");
  const RunResult r = run("mesh m.obj --page 128 --padding 2 -o out.obj --preview p.png");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  EXPECT_TRUE(fs::exists(dir_ / "p.png"));
  std::istringstream lines(read("out.obj"));
  std::vector<std::pair<double, double>> vt, uv;  // uv: 3 a triangle
  for (std::string line; std::getline(lines, line);) {
    double u = 0, v = 0;
    std::size_t t[3];
    if (std::sscanf(line.c_str(), "vt %lf %lf", &u, &v) == 2) vt.emplace_back(u, v);
    if (std::sscanf(line.c_str(), "f %*d/%zu %*d/%zu %*d/%zu", &t[0], &t[1], &t[2]) == 3)
      for (const std::size_t k : t) uv.push_back(vt.at(k - 1));
  }
  ASSERT_EQ(uv.size(), 12u);
  const auto area = [&](std::size_t k) {
    return std::abs((uv[k + 1].first - uv[k].first) * (uv[k + 2].second - uv[k].second) -
                    (uv[k + 1].second - uv[k].second) * (uv[k + 2].first - uv[k].first));
  };
  for (std::size_t k = 3; k < 12; k += 3) EXPECT_NEAR(area(k), area(0), 1e-6);
  EXPECT_GT(area(0), 0.1);
}

// Eight right triangles, far apart in their own uvs.
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

// Two squares of two triangles each whose corners all have their own vt: still two charts.
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
  // A material file that is read stays.
  write("mine.mtl", "newmtl red\n");
  write("other.obj", "mtllib mine.mtl\n" + read("m.obj"));
  const RunResult over = run("mesh other.obj -o mine.obj");
  EXPECT_EQ(over.exit_code, 2) << over.output;
  EXPECT_EQ(read("mine.mtl"), "newmtl red\n");
}

TEST_F(AtlasPack, InterruptLeavesNothing) {
  std::string obj, sizes;
  for (int i = 0; i < 12; ++i) {
    const double w = 1 + 0.37 * (i % 5), h = 2 - 0.11 * i;
    obj += fmt::format("v {0} 0 0\nv {1} 0 0\nv {0} {2} 0\nvt {0} 0\nvt {1} 0\nvt {0} {2}\n", 5 * i,
                       5 * i + w, h);
    obj += fmt::format("f {0}/{0} {1}/{1} {2}/{2}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3);
    sizes += fmt::format("{},{}\n", 13 + 7 * i, 90 - 5 * i);
  }
  write("m.obj", obj);
  write("r.csv", sizes);
  // A shell's background jobs ignore the signal until they have a handler of their own, which a
  // busy machine may take long to come to.
  const std::string interrupt =
      "& for i in $(seq 200); do grep -q 'SigCgt:.*[2367abef]$' /proc/$!/status && break;"
      " sleep 0.1; done; sleep 0.3; kill -INT $!; wait $!";
  for (const char* what : {"mesh m.obj -o out.obj", "rects r.csv --page 128x0 -o out.csv"}) {
    const RunResult r = run(fmt::format("{} --preset best --budget 60s {}", what, interrupt));
    EXPECT_EQ(r.exit_code, 130) << what << ": " << r.output;
    for (const auto& entry : fs::directory_iterator(dir_))
      EXPECT_TRUE(entry.path().filename() == "m.obj" || entry.path().filename() == "r.csv")
          << entry.path();
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
  EXPECT_LE(pages("--max-pages 2")["pages"].size(), 2u);
  // Seed and effort alone decide about `best`.
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
  EXPECT_EQ(run("mesh t.obj -o out.obj --max-width 99").exit_code, 2);  // charts: square pages
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

// A lone carriage return was none: "1,2" and "3,4" became one rectangle "1" of 23 x 4.
TEST_F(AtlasPack, LinesMayEndByCarriageReturnsAlone) {
  write("mac.csv", "name,width,height\ra,10,20\rb,30,40\r");
  ASSERT_EQ(run("rects mac.csv -o placed.csv").exit_code, 0);
  EXPECT_NE(read("placed.csv").find("a,0,"), std::string::npos) << read("placed.csv");
  EXPECT_NE(read("placed.csv").find(",30,40,0\n"), std::string::npos) << read("placed.csv");
  write("bad.csv", "10,20\r\n30,40\rx,y\r");
  EXPECT_NE(run("rects bad.csv -o placed.csv").output.find("bad.csv:3: "), std::string::npos);
}

TEST_F(AtlasPack, WrongJsonNamesItsLine) {
  write("cut.json", "[[1, 2],\n[3, 4],\n[5,");
  EXPECT_NE(run("rects cut.json -o a.csv").output.find("cut.json:3: not valid JSON"),
            std::string::npos);
  write("large.json", "[[1, 2],\n[3, 1e999]]");
  EXPECT_NE(run("rects large.json -o a.csv").output.find("large.json: holds a number beyond"),
            std::string::npos);
}

// It waited for the writer, and signals did not end that.
TEST_F(AtlasPack, APipeWithoutAWriterCanBeInterrupted) {
  ASSERT_EQ(::mkfifo((dir_ / "pipe").c_str(), 0600), 0);
  const RunResult r = run("rects pipe -o a.csv & sleep 0.5; kill $!; wait $!");
  EXPECT_EQ(r.exit_code, 130) << r.output;
  EXPECT_FALSE(fs::exists(dir_ / "a.csv"));
  const RunResult fed =
      run(fmt::format("rects pipe -o a.csv & (sleep 0.3; echo 5,6; sleep 0.3; echo 7,8) >'{}'; "
                      "wait $!",
                      (dir_ / "pipe").string()));
  EXPECT_NE(fed.output.find("2 items on 1 page"), std::string::npos) << fed.output;
}

TEST_F(AtlasPack, WhatIsNoFileInAFolderOfImagesIsNamed) {
  fs::create_directories(dir_ / "in");
  ASSERT_TRUE(atlas::write_png(dir_ / "in/a.png", atlas::Image8(4, 4, 3, 9), {}).ok());
  fs::create_symlink("gone", dir_ / "in/b.png");
  fs::create_directory_symlink(".", dir_ / "in/c");
  const RunResult r = run("images in -o out");
  EXPECT_EQ(r.exit_code, 0) << r.output;
  EXPECT_NE(r.output.find("in/b.png: left out, no file to read"), std::string::npos) << r.output;
  EXPECT_NE(r.output.find("in/c: left out, a link to a folder"), std::string::npos) << r.output;
}

}  // namespace
