// Tests result files, fits, fronts and comparisons with invented numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "benchmarks/support/compare.h"
#include "benchmarks/support/pareto.h"
#include "tests/benchmarks/some_results.h"

namespace atlas::bench {
namespace {

TEST(Results, SurviveTheirFile) {
  const TempFolder folder;
  Results results = some_results();
  results.rows[1].values[1].second = NAN;
  results.rows[2].failure = "timed out";
  ASSERT_TRUE(save(results, folder.path / "r.json").ok());
  const Result<Results> back = load(folder.path / "r.json");
  ASSERT_TRUE(back.ok()) << back.status().message();
  EXPECT_EQ(back->machine.command, "atlas-bench --work \"sphere:10 000\"");
  EXPECT_EQ(back->machine.compiler, results.machine.compiler);
  ASSERT_EQ(back->rows.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(back->rows[i].key(), results.rows[i].key());
    EXPECT_EQ(back->rows[i].cpu_seconds, results.rows[i].cpu_seconds);
    EXPECT_EQ(back->rows[i].failure, results.rows[i].failure);
    EXPECT_EQ(back->rows[i].value("seam"), 5);
  }
  EXPECT_TRUE(std::isnan(back->rows[1].value("l2")));
  ASSERT_EQ(back->checks.size(), 1u);
  EXPECT_TRUE(back->checks[0].holds());
  ASSERT_EQ(back->fits.size(), results.fits.size());
}

TEST(Results, MachinesAreCounted) {
  EXPECT_EQ(machine_count({}), 0u);
  Results same = some_results(), other = some_results();
  same.machine.date = "another day";
  same.machine.system = "another kernel";
  same.machine.command = "another command";
  EXPECT_EQ(machine_count(std::vector{some_results(), same}), 1u);
  other.machine.processor = "another processor";
  EXPECT_EQ(machine_count(std::vector{some_results(), same, other}), 2u);
}

TEST(Results, BadFilesAreNamed) {
  const TempFolder folder;
  EXPECT_EQ(load(folder.path / "none.json").status().code(), ErrorCode::not_found);
  const auto expect_refused = [&](const char* text, const char* complaint) {
    const fs::path path = folder.path / "other.json";
    std::ofstream(path) << text;
    const Status status = load(path).status();
    EXPECT_EQ(status.code(), ErrorCode::bad_input) << text;
    EXPECT_NE(status.message().find("other.json: "), std::string::npos) << status.message();
    EXPECT_NE(status.message().find(complaint), std::string::npos) << status.message();
  };
  for (const char* other : {"{}", "{", "[", "[]", "", "[1, 2]", "{\"format\": 3}",
                            "{\"format\":\"other\"}", "solid cube"})
    expect_refused(other, "not a result file of atlas-bench");
  expect_refused("{\"format\": \"libatlas-bench-1\"}", "damaged");
}

TEST(Results, TargetsAreTriedBeforeARun) {
  const TempFolder folder;
  const fs::path fresh = folder.path / "fresh.json";
  EXPECT_TRUE(check_target("").ok());
  EXPECT_TRUE(check_target(fresh).ok());
  EXPECT_FALSE(fs::exists(fresh));
  ASSERT_TRUE(save(some_results(), fresh).ok());
  EXPECT_TRUE(check_target(fresh).ok());
  EXPECT_TRUE(load(fresh).ok());  // it still exists
  EXPECT_FALSE(check_target(folder.path / "missing" / "r.json").ok());
  EXPECT_FALSE(check_target(folder.path).ok());
}

// The cited line of the file must contain what it is cited for.
TEST(Results, EveryRowAndCheckCitesItsLine) {
  const TempFolder folder;
  Results results = some_results();
  results.checks.push_back({"scale", "x 3", "other", 0.5, 1, ""});
  ASSERT_TRUE(save(results, folder.path / "r.json").ok());
  std::ifstream file(folder.path / "r.json");
  std::vector<std::string> lines{""};
  for (std::string text; std::getline(file, text);) lines.push_back(text);
  const Result<Results> back = load(folder.path / "r.json");
  ASSERT_TRUE(back.ok());
  const auto cited = [&](const std::string& source) {
    EXPECT_EQ(source.rfind("r.json:", 0), 0u) << source;
    const std::size_t number = std::stoul(source.substr(7));
    return number < lines.size() ? lines[number] : std::string();
  };
  for (const Row& r : back->rows)
    EXPECT_NE(cited(r.source).find("\"mesh\":\"" + r.mesh + "\""), std::string::npos) << r.source;
  for (const Check& c : back->checks)
    EXPECT_NE(cited(c.source).find("\"quantity\":\"" + c.quantity + "\""), std::string::npos);
}

TEST(Fits, FindTheExponentOfAPowerLaw) {
  const std::vector<Fit> fits = some_results().fits;
  ASSERT_EQ(fits.size(), 2u);
  EXPECT_EQ(fits[0].quantity, "cpu_seconds");
  EXPECT_NEAR(fits[0].exponent, 1.07, 1e-9);
  EXPECT_NEAR(fits[0].factor, 2e-5, 1e-12);
  EXPECT_NEAR(fits[1].exponent, 0, 1e-9);
  EXPECT_EQ(fits[0].points, 3u);
}

TEST(Fits, LeaveSmallAndFailedRowsOut) {
  std::vector<Row> rows{row(100, 1, 1), row(20000, 1, 1), row(40000, 2, 1), row(80000, 64, 1)};
  rows[3].failure = "no";
  const std::vector<Fit> fits = fit_exponents(rows, 10000);
  ASSERT_EQ(fits.size(), 2u);
  EXPECT_NEAR(fits[0].exponent, 1, 1e-12);
  EXPECT_EQ(fits[0].smallest, 20000u);
}

TEST(Fits, KeepThreadsAndFilesApart) {
  std::vector<Row> rows{row(20000, 1, 1), row(40000, 2, 1), row(20000, 3, 1), row(40000, 12, 1)};
  rows[2].threads = rows[3].threads = 2;
  EXPECT_NE(rows[0].key(), rows[2].key());
  const std::vector<Fit> fits = fit_exponents(rows, 10000);
  ASSERT_EQ(fits.size(), 4u);
  EXPECT_NEAR(fits[0].exponent, 1, 1e-12);
  EXPECT_NEAR(fits[2].exponent, 2, 1e-12);
  for (Row& r : rows) r.mesh = "file:" + r.mesh;
  EXPECT_TRUE(fit_exponents(rows, 10000).empty());
}

TEST(Compare, InstructionsStandInForTimeWhereBothCountThem) {
  Results base = some_results();
  for (Row& r : base.rows) r.instructions = 1e9;
  Results head = base;
  head.rows[0].cpu_seconds *= 10;
  EXPECT_TRUE(compare(base, head, {}).empty());
  head.rows[1].instructions *= 1.03;
  const std::vector<Regression> found = compare(base, head, {});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, Regression::instructions);
}

TEST(Compare, EqualFilesHaveNoRegression) {
  EXPECT_TRUE(compare(some_results(), some_results(), {}).empty());
}

TEST(Compare, NeedsBothThresholdsAndPutsQualityFirst) {
  const Results base = some_results();
  Results head = base;
  head.rows[0].cpu_seconds *= 1.1;    // below the relative threshold
  head.rows[1].cpu_seconds *= 2;      // above both thresholds
  head.rows[2].values[0].second = 6;  // worse error
  std::vector<Regression> found = compare(base, head, {});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].kind, Regression::quality);
  EXPECT_EQ(found[1].kind, Regression::time);
  CompareOptions lenient;
  lenient.time_absolute = 1e6;
  lenient.quality_absolute = 2;
  EXPECT_TRUE(compare(base, head, lenient).empty());
  EXPECT_TRUE(compare(head, base, {}).empty()) << "an improvement is no regression";
}

TEST(Compare, TimesOfOtherMachinesAreLeftOut) {
  const Results base = some_results();
  Results head = base;
  head.rows[0].cpu_seconds *= 10;
  head.rows[1].memory_mib *= 10;
  EXPECT_EQ(compare(base, head, {}).size(), 2u);
  head.machine.compiler = "another compiler";
  const std::vector<Regression> found = compare(base, head, {});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, Regression::memory);
}

TEST(Compare, SeesMissingFailedAndBrokenRows) {
  const Results base = some_results();
  Results head = base;
  head.rows.erase(head.rows.begin());
  head.rows[0].failure = "crashed";
  head.rows[1].values[0].second = NAN;
  head.checks[0].value = 2;
  const std::vector<Regression> found = compare(base, head, {});
  ASSERT_EQ(found.size(), 4u);
  EXPECT_EQ(found[0].kind, Regression::quality);
  EXPECT_EQ(found[1].kind, Regression::quality);
  EXPECT_EQ(found[2].kind, Regression::missing);
  EXPECT_EQ(found[3].kind, Regression::failed);
}

// Returns the regressions if one value of a row changes from `base` to `head`.
std::vector<Regression> changed(const char* stage, const char* name, double base, double head) {
  Results before;
  before.rows.push_back(row(1000, 1, 5));
  before.rows[0].stage = stage;
  before.rows[0].values = {{name, base}};
  Results after = before;
  after.rows[0].values.back().second = head;
  return compare(before, after, {});
}

TEST(Compare, LooksAtEveryValueThatHasABetterWay) {
  EXPECT_EQ(changed("charts", "flips", 0, 1).size(), 1u);
  EXPECT_EQ(changed("unwrap", "without_uv", 0, 5000).size(), 1u);
  EXPECT_EQ(changed("unwrap", "util", 0.75, 0.5).size(), 1u);
  EXPECT_EQ(changed("unwrap", "util", 0.5, 0.75).size(), 0u);
  EXPECT_EQ(changed("export", "psnr", 50, 40).size(), 1u);
  EXPECT_EQ(changed("export", "psnr", 50, 60).size(), 0u);
  EXPECT_EQ(changed("unwrap", "p999", 1.10, 1.11).size(), 1u) << "a tenth more than perfection";
  EXPECT_EQ(changed("baking", "p999", 0.100, 0.101).size(), 0u) << "a hundredth more error";
  EXPECT_EQ(changed("shadows", "ssim", 0.995, 0.990).size(), 1u) << "twice as far from equal";
  EXPECT_EQ(changed("charts", "solve_cpu", 1, 9).size(), 0u);
  EXPECT_EQ(changed("light_leak", "edge_m", 1, 9).size(), 0u);
  const std::vector<Regression> found = changed("charts", "l2", 1.0010, 1.0020);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, Regression::quality);
  EXPECT_EQ(found[0].what, "charts | sphere:1000 | standard: l2 1.001 -> 1.002");
}

TEST(Compare, SeesMoreChartsAndTriangles) {
  Results base;
  base.rows.push_back(row(1000, 1, 5));
  base.rows[0].size_out = 10;
  Results head = base;
  head.rows[0].size_out = 12;
  const std::vector<Regression> found = compare(base, head, {});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].what, "charts | sphere:1000 | standard: charts 10 -> 12");
  EXPECT_TRUE(compare(head, base, {}).empty());
  base.rows[0].stage = head.rows[0].stage = "baseline";
  EXPECT_TRUE(compare(base, head, {}).empty());
}

// A value whose better way nobody stated would never be compared.
TEST(Compare, KnowsEveryPublishedValue) {
  std::size_t rows = 0;
  for (const auto& entry : fs::directory_iterator(ATLAS_PUBLISHED_RESULTS)) {
    const Result<Results> results = load(entry.path());
    ASSERT_TRUE(results.ok()) << results.status().message();
    for (const Row& r : results->rows) {
      ++rows;
      for (const auto& [name, value] : r.values)
        EXPECT_NE(better_of(name), Better::unknown) << r.key() << ": " << name;
    }
  }
  EXPECT_GT(rows, 100u);
}

TEST(Pareto, KeepsWhatNothingBeats) {
  using Point = std::pair<double, double>;
  const auto x = [](const Point& p) { return p.first; };
  const auto y = [](const Point& p) { return p.second; };
  const std::vector<Point> points{{3, 1}, {1, 5}, {2, 6}, {2, 2}, {4, 1}, {1, 7}};
  EXPECT_EQ(pareto_front(points, x, y), (std::vector<Point>{{1, 5}, {2, 2}, {3, 1}}));
  EXPECT_TRUE(pareto_front(std::vector<Point>{}, x, y).empty());
}

}  // namespace
}  // namespace atlas::bench
