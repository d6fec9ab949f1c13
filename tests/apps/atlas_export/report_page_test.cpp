// The page of --report, opened in a browser, and the picture of --false-colour.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>

#include "libatlas/image/image_io.h"
#include "tests/apps/atlas_export/run_export.h"
#include "tests/support/program_output.h"

namespace atlas::test {
namespace {

using Json = nlohmann::json;

// Returns the figure at a key such as "stages.0.wall_ms".
Json at(const Json& report, const std::string& key) {
  Json value = report;
  std::istringstream names(key);
  for (std::string name; std::getline(names, name, '.');)
    value = value.is_array() ? value.at(std::stoul(name)) : value.at(name);
  return value;
}

TEST_F(AtlasExport, TheReportIsAPageWhoseFiguresAreTheJsons) {
  if (output_of("chromium --version").empty()) GTEST_SKIP() << "there is no chromium to open pages";
  write("b<o>x.obj", lit_box(12));
  const RunResult r =
      run(fmt::format("'{0}/b<o>x.obj' -o {0}/world.glb --atlases 2 --atlas-size 256 --texel 2cm "
                      "--texture-format webp --quality 50 --report {0}/r.json --report {0}/r.html",
                      dir_.string()));
  ASSERT_EQ(r.exit_code, 0) << r.output;
  const Json report = Json::parse(slurp(dir_ / "r.json"));
  EXPECT_FALSE(report["error"]["worst"].empty());

  // Without a network, and with the console on stderr.
  const std::string opened = fmt::format(
      "timeout 120 chromium --headless --no-sandbox --disable-gpu --user-data-dir={0}/profile "
      "--host-resolver-rules='MAP * ~NOTFOUND' --enable-logging=stderr --virtual-time-budget=10000 "
      "--dump-dom 'file://{0}/r.html' 2>{0}/console",
      dir_.string());
  const std::string page = output_of(opened);
  const std::string console = slurp(dir_ / "console");
  EXPECT_EQ(console.find("CONSOLE"), std::string::npos) << console;
  EXPECT_EQ(slurp(dir_ / "r.html").find("http://"),
            slurp(dir_ / "r.html").find("http://www.w3.org"))
      << "a request";

  const std::regex figure("data-key=\"([^\"]*)\" data-value=\"([^\"]*)\"");
  int figures = 0;
  for (auto i = std::sregex_iterator(page.begin(), page.end(), figure); i != std::sregex_iterator();
       ++i, ++figures)
    EXPECT_EQ(std::stod((*i)[2]), at(report, (*i)[1]).get<double>()) << (*i)[1];
  EXPECT_GT(figures, 60);
  for (const char* key : {"error.psnr", "charts.count", "grouping.capacity", "light.white",
                          "packing.uv_utilization", "files.0.bytes"})
    EXPECT_NE(page.find(fmt::format("data-key=\"{}\"", key)), std::string::npos) << key;
  // Names of files are text, and no part of the page.
  EXPECT_EQ(page.find("<o>"), std::string::npos);
  EXPECT_NE(page.find("b&lt;o&gt;x.obj"), std::string::npos);
  for (const char* word : {"--quality 50", "texture-format", "skipped", "polyline", "<canvas"})
    EXPECT_NE(page.find(word), std::string::npos) << word;
}

TEST_F(AtlasExport, APlanIsAPageToo) {
  if (output_of("chromium --version").empty()) GTEST_SKIP() << "there is no chromium to open pages";
  write("box.obj", lit_box(4));
  ASSERT_EQ(run(fmt::format("{0}/box.obj --plan --report {0}/r.html", dir_.string())).exit_code, 0);
  const std::string page = output_of(fmt::format(
      "timeout 120 chromium --headless --no-sandbox --disable-gpu --user-data-dir={0}/profile "
      "--enable-logging=stderr --dump-dom 'file://{0}/r.html' 2>{0}/console",
      dir_.string()));
  EXPECT_EQ(slurp(dir_ / "console").find("CONSOLE"), std::string::npos) << slurp(dir_ / "console");
  EXPECT_NE(page.find("exposure"), std::string::npos);
  EXPECT_EQ(page.find("id=\"error\""), std::string::npos);
}

// Returns a floor of 4 x 4 m, lit in four stripes, with a table 0.5 m above it and a ceiling.
std::string striped_room() {
  std::string obj;
  const auto quad = [&](double x0, double x1, double height, double light) {
    for (const auto& [x, z] : {std::pair(x0, 0.0), {x0, 4.0}, {x1, 4.0}, {x1, 0.0}})
      obj += fmt::format("v {} {} {} {} {} {}\n", x, height, z, light, light, light);
    obj += "f -4 -3 -2 -1\n";
  };
  for (int i = 0; i < 4; ++i) quad(i, i + 1, 0, 3 * std::pow(10, i));  // 3, 30, 300, 3000
  quad(1.25, 1.75, 0.5, 3000);
  quad(0, 4, 2.5, 3);
  return obj;
}

TEST_F(AtlasExport, FalseColoursShowTheLightFromAbove) {
  write("room.obj", striped_room());
  const RunResult r =
      run(fmt::format("{0}/room.obj -o {0}/w.glb --false-colour {0}/lux.png", dir_.string()));
  ASSERT_EQ(r.exit_code, 0) << r.output;
  const auto picture = read_image8(dir_ / "lux.png");
  ASSERT_TRUE(picture.ok()) << picture.status().message();
  // The plan of 900 x 900 pixels lies 16 pixels from the upper left corner.
  const auto colour = [&](double x, double y) {
    const std::uint8_t* p =
        picture->at(16 + int(x / 4 * 899), picture->height - 16 - 900 + int(y / 4 * 899));
    return std::array{p[0], p[1], p[2]};
  };
  std::set<std::array<std::uint8_t, 3>> stripes;
  for (int i = 0; i < 4; ++i) stripes.insert(colour(i + 0.9, 1));
  EXPECT_EQ(stripes.size(), 4u) << "each stripe has its colour, and the ceiling is cut away";
  EXPECT_EQ(colour(1.5, 2), colour(3.5, 2)) << "the table has the light of the last stripe";
  EXPECT_NE(colour(1.1, 2), colour(1.5, 2));
}

TEST_F(AtlasExport, FalseColoursNeedLightAndAPng) {
  const fs::path scene = write("dark.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  expect_refusal(scene, "--false-colour", fmt::format("-q --false-colour {}/a.png", dir_.string()));
  write("box.obj", lit_box(4));
  expect_refusal(dir_ / "box.obj", "--false-colour",
                 fmt::format("--false-colour {}/a.jpg", dir_.string()));
}

}  // namespace
}  // namespace atlas::test
