// Tests the pages of tables with invented numbers.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>

#include "benchmarks/page/page.h"
#include "tests/benchmarks/some_results.h"

namespace atlas::bench {
namespace {

// Returns the page in Markdown after saving and loading the results as JSON, or an empty string if
// that fails.
std::string written_page(const Results& results, const fs::path& folder) {
  if (!save(results, folder / "all.json").ok()) return {};
  const Result<Results> loaded = load(folder / "all.json");
  if (!loaded.ok() || !write_page({{*loaded}}, folder).ok()) return {};
  std::ifstream file(folder / "performance.md");
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Page, TablesForThreadsInstructionsAndRivals) {
  const TempFolder folder;
  Results results = some_results();
  results.checks.clear();
  for (const int threads : {1, 2}) {
    results.rows.push_back(row(5000, 7, 1));
    results.rows.back().threads = threads;
    results.rows.back().wall_seconds = 7.0 / threads;
  }
  results.rows.push_back(row(6000, 0, 1));
  results.rows.back().instructions = 123e6;
  results.rows.push_back(row(7000, 60, 1));
  results.rows.back().stage = "unwrap";
  results.rows.back().setting = "slow program";
  results.rows.back().failure = "timed out after 60 s";
  const std::string page = written_page(results, folder.path);
  for (const char* text : {"## Threads", "| 2.00 | all.json:", "## Instructions", "| 123.00 |",
                           "slow program | 7000 | timed out after 60 s", "## Stage: charts"})
    EXPECT_NE(page.find(text), std::string::npos) << text;
  EXPECT_EQ(page.find("Stage: unwrap"), std::string::npos);
  // Rows of the thread series and rows with counted instructions are not in the stage's own table.
  const std::string stage = page.substr(page.find("## Stage: charts"));
  EXPECT_EQ(stage.find("sphere:5000 "), std::string::npos);
  EXPECT_EQ(stage.find("sphere:6000 "), std::string::npos);
}

// If a mesh takes more than twelve times "parse + normals", the page names the parts that take most
// of it.
TEST(Page, TellsWhichPartsOfChartsTakeTheTime) {
  const TempFolder folder;
  Results results;
  for (const double seconds : {1.0, 4.0}) {
    results.rows.push_back(row(1000000, 0.1, 1));
    results.rows.back().mesh = seconds > 2 ? "scan:1000000" : "terrain:1000000";
    Row charts = results.rows.back();
    results.rows.back().stage = "baseline";
    results.rows.back().setting = "parse + normals";
    charts.cpu_seconds = seconds;
    for (const char* part : {"topology_cpu", "cells_cpu", "solve_cpu"})
      charts.values.emplace_back(part, 0.01 * seconds);
    charts.values.emplace_back("merging_cpu", 0.6 * seconds);
    results.rows.push_back(charts);
  }
  const std::string page = written_page(results, folder.path);
  EXPECT_NE(page.find("scan:1000000, 40.0 times: 60 % merging"), std::string::npos);
  EXPECT_EQ(page.find("terrain:1000000, 10.0 times"), std::string::npos);
  const std::string parts = page.substr(page.find("| mesh | charts, s |"));
  EXPECT_NE(parts.find("| scan:1000000 | 4.00 | 0.4 |"), std::string::npos) << parts;
  EXPECT_NE(parts.find("| 14.8 | all.json:"), std::string::npos) << "what no part counts";
  const std::string stage = page.substr(page.find("## Stage: charts"));
  EXPECT_EQ(stage.find("merging_cpu"), std::string::npos);
}

// Returns a file that the page folder holds.
std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Page, HoldsEveryRowAndCheck) {
  const TempFolder folder;
  Results results = some_results(), checked;
  std::swap(results.checks, checked.checks);
  checked.checks.push_back({"scale", "x 3", "drift", 2, 1, ""});
  ASSERT_TRUE(write_page({{results, checked}}, folder.path).ok());
  const std::string page = text_of(folder.path / "index.html");
  const std::string stable = text_of(folder.path / "stability.md");
  for (const char* text : {"sphere:10000", "sphere:1000000", "1.07", "atlas-bench --work"})
    EXPECT_NE(page.find(text), std::string::npos) << text;
  EXPECT_NE(stable.find("2 figures, 1 beyond their bound"), std::string::npos);
  EXPECT_NE(stable.find("EXCEEDED"), std::string::npos);
}

// Saves and loads both, so that rows name their file, and writes the pages.
bool write_both(const Results& speed, const Results& checked, const fs::path& folder) {
  if (!save(speed, folder / "speed.json").ok() || !save(checked, folder / "checked.json").ok())
    return false;
  const Result<Results> first = load(folder / "speed.json"), second = load(folder / "checked.json");
  return first.ok() && second.ok() && write_page({{*first, *second}}, folder).ok();
}

// Groups of checks are called after stages, whose rows belong to the performance page all the same.
TEST(Page, LosesNoStageThatIsNamedLikeAGroupOfChecks) {
  const TempFolder folder;
  Results speed, checked;
  for (const char* stage : {"packing", "charts"})
    for (const int threads : {0, 1, 2}) {
      speed.rows.push_back(row(1000, 1, 0.5));
      speed.rows.back().stage = stage;
      speed.rows.back().threads = threads;
    }
  speed.rows.push_back(row(1000, 0, 0.5));
  speed.rows.back().stage = "packing";
  speed.rows.back().instructions = 5e6;
  checked.checks.push_back({"packing", "x 2", "drift", 0.1, 1, ""});
  for (const char* stage : {"packing", "conditioning"}) {
    checked.rows.push_back(row(2000, 1, 0.5));
    checked.rows.back().stage = stage;
  }
  ASSERT_TRUE(write_both(speed, checked, folder.path));
  const std::string page = text_of(folder.path / "performance.md");
  const std::string stable = text_of(folder.path / "stability.md");
  EXPECT_NE(page.find("## Stage: packing"), std::string::npos);
  for (const std::size_t line : {4, 5, 7, 8, 10})  // the second of a thread series is in its row
    EXPECT_NE(page.find(" speed.json:" + std::to_string(line) + " |"), std::string::npos) << line;
  EXPECT_EQ(page.find("checked.json"), std::string::npos);
  for (const char* cited : {"checked.json:4 |", "checked.json:5 |"})
    EXPECT_NE(stable.find(cited), std::string::npos) << cited;
  EXPECT_EQ(stable.find("speed.json"), std::string::npos);
}

// A stage that comes first need not be the first of the alphabet. A mesh may lack a stage.
TEST(Page, TheStagesOfAnExportCiteTheirFirstLine) {
  const TempFolder folder;
  Results results;
  for (const char* stage : {"export/exposure", "export/baking"}) {
    results.rows.push_back(row(1000, 4, 0.5));
    results.rows.back().stage = stage;
  }
  results.rows.push_back(row(2000, 5, 0.5));
  results.rows.back().stage = "export/baking";
  const std::string page = written_page(results, folder.path);
  for (const char* line :
       {"| mesh | exposure | baking | JSON |", "| sphere:1000 | 4.00 | 4.00 | all.json:4 |",
        "| sphere:2000 | - | 5.00 | all.json:6 |"})
    EXPECT_NE(page.find(line), std::string::npos) << line;
}

// An error of 0 would be the best there is.
TEST(Page, ValuesThatARowLacksAreNotZero) {
  const TempFolder folder;
  Results results;
  for (const char* stage : {"charts", "unwrap"})
    for (const bool whole : {true, false}) {
      results.rows.push_back(row(1000, 4, 0.5));
      results.rows.back().stage = stage;
      if (!whole) results.rows.back().values = {{"seam", std::nan("")}};
    }
  const std::string page = written_page(results, folder.path);
  for (const char* cells : {"| 0.5 | 1.0100 | all.json:4 |", "| - | - | all.json:5 |",
                            "| 0.5 | 1.0100 | all.json:6 |", "| - | - | all.json:7 |"})
    EXPECT_NE(page.find(cells), std::string::npos) << cells;
}

// Images are written while the next pages are baked: their wall time alone would show a speed-up
// beyond the number of threads.
TEST(Page, BakingAndImagesAreOneRowOfTheThreads) {
  const TempFolder folder;
  Results results;
  const auto add = [&](const char* stage, int threads, double wall) {
    results.rows.push_back(row(1000, 4, 0.5));
    results.rows.back().stage = stage;
    results.rows.back().threads = threads;
    results.rows.back().wall_seconds = wall;
  };
  for (const int threads : {1, 2}) {
    add("export/baking", threads, threads == 1 ? 9 : 6.5);
    add("export/images", threads, threads == 1 ? 4 : 0.5);
  }
  const std::string page = written_page(results, folder.path);
  EXPECT_NE(page.find("| export/baking + images | sphere:1000 | 13.00 | 7.00 | 8.00 | 8.00 | 1.86"),
            std::string::npos)
      << page;
}

}  // namespace
}  // namespace atlas::bench
