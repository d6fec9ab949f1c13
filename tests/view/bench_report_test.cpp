// The bench's files, written from figures that no measurement gave.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "libatlas/view/bench.h"
#include "libatlas/view/shadow_text.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::TempFolder;

Spread spread(double p50) {
  return {p50 * 1.5, p50, p50 * 2, p50 * 3, p50 * 4, p50 * 5};
}

BenchRun run(Shading shading, ShadowMethod method, float wall) {
  BenchRun r;
  r.shading = shading;
  r.method = method;
  for (const float scale : {1.0f, 2.0f}) {
    FrameTime f;
    f.wall = wall * scale;
    f.cpu = 2 * f.wall;
    f.gpu_shadow = 3 * f.wall;
    f.gpu_lit = 5 * f.wall;
    f.triangles_shadow = 11;
    f.triangles_lit = 13;
    r.frames.push_back(f);
  }
  r.wall = spread(double(wall));
  r.cpu = spread(2 * double(wall));
  r.gpu = spread(8 * double(wall));
  r.shadow_share = 0.375;
  r.work_mean = 24;
  r.work_worst = 25;
  return r;
}

BenchError error(ShadowMethod method, int interval, double psnr) {
  BenchError e;
  e.method = method;
  e.interval = interval;
  e.visibility = {0.01 * interval, 0.02, 0.03, 0.04, 0.05};
  e.psnr = psnr;
  e.ssim = 0.75;
  e.cpu_median = 0.001 * interval;
  e.gpu_median = 0.002 * interval;
  return e;
}

BenchResult result(bool software) {
  BenchResult r;
  r.device = "device";
  r.version = "4.5";
  r.software = software;
  r.width = 640;
  r.height = 480;
  r.map_resolution = 1024;
  r.interval = 8;
  r.pcf = 3;
  r.triangles = 99;
  r.times.runs = {run(Shading::lambert, ShadowMethod::classic, 0.25f),
                  run(Shading::lambert, ShadowMethod::march, 0.125f),
                  run(Shading::ward, ShadowMethod::march, 0.5f)};
  r.times.control = {77, spread(0.5), spread(0.25)};
  r.errors = {error(ShadowMethod::march, 8, 40), error(ShadowMethod::hold, 4, 30),
              error(ShadowMethod::march, 2, std::numeric_limits<double>::infinity())};
  return r;
}

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> all;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) all.push_back(line);
  return all;
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(BenchReport, FramesAreTheRowsOfTheTable) {
  const TempFolder folder;
  ASSERT_TRUE(write_bench(result(true), folder.path()).ok());
  EXPECT_EQ(lines(TempFolder::read(folder / "frames.csv")),
            (std::vector<std::string>{
                "shading,shadows,frame,wall_ms,cpu_ms,gpu_shadow_ms,gpu_lit_ms,triangles_shadow,"
                "triangles_lit",
                "lambert,classic,0,250.0000,500.0000,750.0000,1250.0000,11,13",
                "lambert,classic,1,500.0000,1000.0000,1500.0000,2500.0000,11,13",
                "lambert,march,0,125.0000,250.0000,375.0000,625.0000,11,13",
                "lambert,march,1,250.0000,500.0000,750.0000,1250.0000,11,13",
                "ward,march,0,500.0000,1000.0000,1500.0000,2500.0000,11,13",
                "ward,march,1,1000.0000,2000.0000,3000.0000,5000.0000,11,13"}));
}

// Data files have one block for each run, which two blank lines end.
TEST(BenchReport, PlotsHaveTheRunsOfTheirMethodOrShading) {
  for (const bool software : {false, true}) {
    const TempFolder folder;
    ASSERT_TRUE(write_bench(result(software), folder.path()).ok());
    EXPECT_EQ(TempFolder::read(folder / "fps-classic.dat"), "0 4.000\n1 2.000\n\n\n");
    EXPECT_EQ(TempFolder::read(folder / "fps-march.dat"),
              "0 8.000\n1 4.000\n\n\n0 2.000\n1 1.000\n\n\n");
    EXPECT_FALSE(std::filesystem::exists(folder / "fps-hold.dat"));
    const std::string cost = software ? "cpu" : "gpu";
    const std::string ward = software ? "0 1000.0000\n1 2000.0000\n" : "0 4000.0000\n1 8000.0000\n";
    EXPECT_EQ(TempFolder::read(folder / (cost + "-ward.dat")), ward + "\n\n");
    EXPECT_EQ(lines(TempFolder::read(folder / (cost + "-lambert.dat"))).size(), 8u);
    EXPECT_FALSE(std::filesystem::exists(folder / (cost + "-unlit.dat")));
    const std::string script = TempFolder::read(folder / "plots.gp");
    EXPECT_TRUE(has(script,
                    "plot 'fps-march.dat' index 0 with lines title 'lambert', "
                    "'fps-march.dat' index 1 with lines title 'ward'\n"));
    EXPECT_TRUE(has(script, "plot '" + cost +
                                "-lambert.dat' index 0 with lines title 'classic', '" + cost +
                                "-lambert.dat' index 1 with lines title 'march'\n"));
    // Errors are sorted by method, then by interval.
    EXPECT_EQ(TempFolder::read(folder / "error.dat"),
              software
                  ? "4.0000 0.04000000 4\n\n\n2.0000 0.02000000 2\n8.0000 0.08000000 8\n\n\n"
                  : "8.0000 0.04000000 4\n\n\n4.0000 0.02000000 2\n16.0000 0.08000000 8\n\n\n");
  }
}

TEST(BenchReport, TheSummaryHasEveryFigure) {
  const TempFolder folder;
  ASSERT_TRUE(write_bench(result(true), folder.path()).ok());
  const auto j = nlohmann::json::parse(TempFolder::read(folder / "summary.json"));
  EXPECT_EQ(j["runs"][1]["shading"], "lambert");
  EXPECT_EQ(j["runs"][1]["shadows"], "march");
  EXPECT_EQ(j["runs"][1]["frames"], 2);
  EXPECT_NEAR(j["runs"][1]["fps_mean"], 1 / 0.1875, 1e-9);
  EXPECT_EQ(j["runs"][1]["shadow_share"], 0.375);
  EXPECT_EQ(j["runs"][1]["triangles_mean"], 24);
  EXPECT_EQ(j["runs"][1]["triangles_worst"], 25);
  const std::pair<const char*, double> clocks[] = {
      {"wall_ms", 125}, {"cpu_ms", 250}, {"gpu_ms", 1000}};
  for (const auto& [clock, p50] : clocks) {
    int factor = 0;
    for (const char* key : {"p50", "p95", "p99", "p999", "worst"})
      EXPECT_EQ(j["runs"][1][clock][key], p50 * ++factor) << clock << ' ' << key;
    EXPECT_EQ(j["runs"][1][clock]["mean"], 1.5 * p50);
    EXPECT_EQ(j["runs"][1][clock]["p95_over_p50"], 2);
  }
  const auto& e = j["errors"][0];
  EXPECT_EQ(e["shadows"], "march");
  EXPECT_EQ(e["k"], 8);
  EXPECT_EQ(e["mean_visibility_error"], 0.08);
  EXPECT_EQ(e["wrong_pixels"], 0.02);
  EXPECT_EQ(e["mean_visibility_error_off_edges"], 0.03);
  EXPECT_EQ(e["wrong_pixels_off_edges"], 0.04);
  EXPECT_EQ(e["edge_band"], 0.05);
  EXPECT_EQ(e["psnr_db"], 40);
  EXPECT_EQ(e["ssim"], 0.75);
  EXPECT_EQ(e["cpu_ms_median"], 8);
  EXPECT_EQ(e["gpu_ms_median"], 16);
  EXPECT_TRUE(j["errors"][2]["psnr_db"].is_null());
  EXPECT_EQ(j["control"]["cpu_ms"]["p50"], 250);
}

// Every row has as many cells as the head above it.
TEST(BenchReport, TablesHaveWholeRows) {
  const std::string table = bench_table(result(true));
  std::ptrdiff_t cells = 0;
  for (const std::string& line : lines(table)) {
    if (line.empty() || line[0] != '|') {
      cells = 0;
      continue;
    }
    std::ptrdiff_t bars = 0;  // one that is escaped belongs to a cell
    for (std::size_t i = 0; i < line.size(); ++i)
      bars += line[i] == '|' && (i == 0 || line[i - 1] != '\\');
    if (cells == 0) cells = bars;
    EXPECT_EQ(bars, cells) << line;
  }
  EXPECT_TRUE(has(table, "device (software renderer), 640 x 480, maps 1024², k = 8, pcf 3, 99 "));
  EXPECT_TRUE(has(table,
                  "| ward | march | 1.3 | 500.0 | 1000.0 | 1500.0 | 2000.0 | 2500.0 | 2.00 "
                  "| 1000.0 | 2000.0 | 2.00 | 4000.0 | 8000.0 | 2.00 | 38 % | 24 | 25 |"))
      << table;
  EXPECT_TRUE(has(table, "| march | 8 | 0.08000 | 0.02000 | 0.03000 | 0.04000 | 40.00 | 0.7500 |"));
  BenchResult empty;
  EXPECT_FALSE(has(bench_table(empty), "|"));
  EXPECT_TRUE(has(bench_table(empty), "(GPU)"));
}

TEST(BenchReport, KeysByDegreesAreToldAsSuch) {
  BenchResult r = result(true);
  r.interval_degrees = 2.5;
  EXPECT_TRUE(has(bench_table(r), "maps 1024², keys every 2.5°, pcf 3, "));
  const TempFolder folder;
  ASSERT_TRUE(write_bench(r, folder.path()).ok());
  const auto j = nlohmann::json::parse(TempFolder::read(folder / "summary.json"));
  EXPECT_TRUE(j["k"].is_null());
  EXPECT_EQ(j.value("interval_degrees", 0.0), 2.5);
}

// Three digits of a time of any size.
TEST(BenchReport, ShortTimesKeepTheirDigits) {
  BenchResult r = result(true);
  r.times.runs = {run(Shading::ward, ShadowMethod::none, 0.000125f)};
  const std::string table = bench_table(r);
  EXPECT_TRUE(has(table, "| 0.125 | 0.250 | 0.375 | 0.500 | 0.625 | 2.00 |")) << table;
  r.times.runs = {run(Shading::ward, ShadowMethod::none, 0x1p-8f)};
  EXPECT_TRUE(has(bench_table(r), "| 3.91 | 7.81 | 11.7 | 15.6 | 19.5 | 2.00 |")) << table;
}

TEST(BenchReport, AFolderThatCannotBeMadeIsTold) {
  const TempFolder folder;
  const auto file = folder.write("file", "");
  for (const auto& place : {file, file / "inside"}) {
    const Status status = write_bench(result(true), place);
    EXPECT_EQ(status.code(), ErrorCode::io);
    EXPECT_EQ(status.message().find(place.string()), 0u) << status.message();
  }
}

TEST(ShadowText, EachFilterHasItsOwnLookUp) {
  const auto text = [](int pcf) {
    ShaderFeatures f;
    f.pcf = pcf;
    f.shadow = ShadowSampling::one;
    return shadow_text(f);
  };
  EXPECT_TRUE(has(text(0), "floor(uv"));
  EXPECT_TRUE(has(text(1), "texture(maps, vec4(uv, layer, depth))"));
  EXPECT_TRUE(has(text(3), "textureGather"));
  EXPECT_TRUE(has(text(5), "x <= 2"));
}

}  // namespace
}  // namespace atlas
