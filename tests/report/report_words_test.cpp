// The JSON report beside its figures: words, names, truths, and what is null or left out.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "libatlas/report/export_report.h"
#include "tests/report/written_report.h"

namespace atlas {
namespace {

using nlohmann::json;
using test::complete_report;
using test::written;

TEST(ReportWords, StagesAndStepsSayWhatTheyAre) {
  ExportReport r = complete_report();
  r.plan.steps = {{"charts", true, "why it runs"}, {"baking", false, "why not"}};
  r.stages[0].stage = "charts";
  r.stages[0].unit = "pieces";
  r.stages[0].quality = "fine";
  const json file = written(r);
  EXPECT_EQ(file["plan"]["steps"],
            json::parse(R"([{"stage": "charts", "run": true, "reason": "why it runs"},
                            {"stage": "baking", "run": false, "reason": "why not"}])"));
  EXPECT_EQ(file["skipped"], json::parse(R"([{"stage": "baking", "reason": "why not"}])"));
  EXPECT_EQ(file["stages"][0]["stage"], "charts");
  EXPECT_EQ(file["stages"][0]["unit"], "pieces");
  EXPECT_EQ(file["stages"][0]["quality"], "fine");
  EXPECT_FALSE(file.contains("grouping")) << "it is no step";
  r.plan.steps = {{"grouping", false, "one page"}};
  EXPECT_FALSE(written(r).contains("grouping")) << "it did not run";
}

TEST(ReportWords, NamesOfFilesAndPagesAreThoseWritten) {
  ExportReport r = complete_report();
  r.scene = "in/scene.obj";
  r.target = "out/world.wrl";
  r.pages[0].image = "world0.png";
  r.files = {{"world.wrl", 3}, {"world0.png", 4}};
  r.not_kept = {"2 lamps"};
  r.advice = {"first", "second"};
  const json file = written(r);
  EXPECT_EQ(file["scene"]["file"], "in/scene.obj");
  EXPECT_EQ(file["target"], "out/world.wrl");
  EXPECT_EQ(file["packing"]["pages"][0]["image"], "world0.png");
  EXPECT_EQ(file["files"], json::parse(R"([{"file": "world.wrl", "bytes": 3},
                                           {"file": "world0.png", "bytes": 4}])"));
  EXPECT_EQ(file["not_kept"], json({"2 lamps"}));
  EXPECT_EQ(file["advice"], json({"first", "second"}));
}

TEST(ReportWords, TheCommandIsThatOfTheProgram) {
  const ExportReport r = complete_report();
  const json file = written(r, {"atlas-export a.obj", {{"--mips", "2"}, {"--quiet", "true"}}});
  EXPECT_FALSE(file["version"].get<std::string>().empty());
  EXPECT_EQ(file["command"], "atlas-export a.obj");
  EXPECT_EQ(file["options"], json::parse(R"({"--mips": "2", "--quiet": "true"})"));
  for (const char* key : {"command", "options"})
    EXPECT_FALSE(written(r, {}).contains(key)) << "the library was called";
}

TEST(ReportWords, RowsOfChartsComeOnRequest) {
  ExportReport r = complete_report();
  r.charts.resize(3);
  EXPECT_EQ(written(r)["charts"]["charts"].size(), 3u);
  const test::TempFolder folder;  // the test's only one: written() has removed its own
  ASSERT_TRUE(write_json(r, folder / "short.json").ok());
  const json file = json::parse(test::TempFolder::read(folder / "short.json"));
  EXPECT_EQ(file["charts"]["count"], 3);
  EXPECT_FALSE(file["charts"].contains("charts"));
}

void add_keys(const json& value, std::set<std::string>& keys) {
  if (value.is_object())
    for (const auto& [key, member] : value.items()) {
      keys.insert(key);
      add_keys(member, keys);
    }
  if (value.is_array())
    for (const json& element : value) add_keys(element, keys);
}

TEST(ReportWords, ThePageExplainsEveryKey) {
  ExportReport r = complete_report();
  r.full_texels = 1;
  r.defects.defects = {{DefectKind::illumination_negative, 1, {}}};
  r.plan.steps.push_back({"baking", false, "why not"});
  std::set<std::string> keys;
  add_keys(written(r), keys);
  ASSERT_GT(keys.size(), 100u);
  std::ifstream file(ATLAS_SOURCE_DIR "/docs/report.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  for (const std::string& key : keys)
    EXPECT_TRUE(page.find("`" + key + "`") != std::string::npos ||
                page.find("`" + key + "[]`") != std::string::npos)
        << key;
}

TEST(ReportWords, DefectsHaveTheirKindCountAndPlaces) {
  ExportReport r = complete_report();
  r.defects.defects = {{DefectKind::texcoord_not_finite, 70, {"a.obj:3", "a.obj:9"}},
                       {DefectKind::illumination_negative, 1, {}}};
  const json defects = written(r)["scene"]["defects"];
  ASSERT_EQ(defects.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const Defect& want = r.defects.defects[i];
    EXPECT_EQ(defects[i]["kind"], name_of(want.kind));
    EXPECT_EQ(defects[i]["meaning"], describe(want.kind));
    EXPECT_EQ(defects[i]["count"], want.count);
    EXPECT_EQ(defects[i]["first"], json(want.first_places));
  }
}

TEST(ReportWords, TruthsAreThoseOfTheReport) {
  for (const bool first : {false, true}) {
    ExportReport r = complete_report();
    r.charts.resize(3);
    r.charts[0].planar_projection = r.charts[1].planar_projection = first;
    r.charts[2].kept = first;
    r.charts[0].cone_degrees = 30;
    r.charts[1].cone_degrees = 10;
    r.outlines = first;
    r.grouping.proved_smallest = r.lit = !first;
    const json file = written(r);
    EXPECT_EQ(file["charts"]["count"], 3);
    EXPECT_EQ(file["charts"]["planar"], first ? 2 : 0);
    EXPECT_EQ(file["charts"]["widest_cone_degrees"], 30);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(file["charts"]["charts"][i]["planar"], r.charts[i].planar_projection);
      EXPECT_EQ(file["charts"]["charts"][i]["kept"], r.charts[i].kept);
    }
    EXPECT_EQ(file["grouping"]["proved_smallest"], !first);
    EXPECT_EQ(file["packing"]["outlines"], first);
    EXPECT_EQ(file["scene"]["lit"], !first);
  }
}

// Only the linear curve can be inverted, and not where it was clipped.
TEST(ReportWords, TheErrorInSceneUnitsNeedsACurveThatCanBeInverted) {
  ExportReport r = complete_report();
  r.full_texels = 1;
  r.fidelity.lit = 5;
  r.fidelity.clipped = 4;
  r.fidelity.rmse = 0.5;
  for (const ToneOperator op : {ToneOperator::linear, ToneOperator::reinhard, ToneOperator::drago,
                                ToneOperator::reinhard_devlin}) {
    r.tone.op = op;
    const json file = written(r);
    EXPECT_EQ(file["light"]["tone"], tone_operator_name(op));
    EXPECT_EQ(file["error"]["rmse"], op == ToneOperator::linear ? json(0.5) : json());
    EXPECT_EQ(file["error"]["samples_lit"], 5);
  }
  r.tone.op = ToneOperator::linear;
  r.fidelity.clipped = 5;
  EXPECT_TRUE(written(r)["error"]["rmse"].is_null());
}

TEST(ReportWords, UnlitPointsAloneDetermineTheirOwnPsnr) {
  ExportReport r = complete_report();
  r.fidelity.unlit = 7;
  r.fidelity.psnr = r.fidelity.psnr_all = 30;
  const json error = written(r)["error"];
  EXPECT_TRUE(error["psnr"].is_null());
  EXPECT_EQ(error["psnr_with_unlit"], 30);
}

TEST(ReportWords, NothingIsDividedByZero) {
  ExportReport r = complete_report();
  r.seam_length = 3;
  EXPECT_EQ(written(r)["charts"]["seam_per_root_area"], 0);
}

// Names of files on Linux are bytes, and JSON is UTF-8.
TEST(ReportWords, BytesThatAreNoUtf8AreReplaced) {
  ExportReport r = complete_report();
  r.scene = "caf\xe9.obj";
  r.advice = {"caf\xc3\xa9"};
  const json file = written(r);
  EXPECT_EQ(file["scene"]["file"], "caf\xef\xbf\xbd.obj");
  EXPECT_EQ(file["advice"][0], "caf\xc3\xa9");
}

TEST(ReportWords, AFolderThatIsNotThereIsTold) {
  const test::TempFolder folder;
  const Status status = write_json({}, folder / "none" / "report.json");
  EXPECT_EQ(status.code(), ErrorCode::io);
  EXPECT_NE(status.message().find("report.json"), std::string::npos);
}

TEST(StageLine, HasTheColumnsOfTheReport) {
  StageReport s;
  s.stage = "charts";
  s.wall_seconds = 9;
  s.cpu_seconds = 0.824;
  s.peak_memory = std::int64_t{120} << 20;
  s.size_in = 301709;
  s.size_out = 68;
  s.unit = "charts";
  s.quality = "L2 1.0012";
  const auto words = [](const std::string& line) {  // each run of blanks as one
    std::string out;
    for (const char c : line)
      if (c != ' ' || out.empty() || out.back() != ' ') out += c;
    return out;
  };
  EXPECT_EQ(words(stage_line(s)), "charts 301709 -> 68 charts, L2 1.0012 0.82 s 120 MiB");
  const std::size_t length = stage_line(s).size();
  s.quality.clear();
  EXPECT_EQ(words(stage_line(s)), "charts 301709 -> 68 charts 0.82 s 120 MiB");
  EXPECT_EQ(stage_line(s).size(), length) << "columns stay below each other";
}

}  // namespace
}  // namespace atlas
