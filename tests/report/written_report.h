// Reports, and what the JSON file says of them.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "libatlas/report/export_report.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {

inline nlohmann::json written(const ExportReport& report,
                              const ReportRequest& request = {"atlas-export", {}, true}) {
  const TempFolder folder;
  EXPECT_TRUE(write_json(report, folder / "report.json", request).ok());
  return nlohmann::json::parse(TempFolder::read(folder / "report.json"));
}

// Returns a report of an export that was carried out with all its parts, one of each kind.
inline ExportReport complete_report() {
  ExportReport r;
  r.carried_out = r.simplified = r.error_measured = true;
  r.plan.steps = {{"grouping", true, ""}};
  r.stages.resize(1);
  r.pages.resize(1);
  r.charts.resize(1);
  r.gaps.emplace();
  r.texels_drawn_twice.emplace();
  r.grouping.group_size = {0};
  r.grouping.trace = {{}};
  r.files = {{"world.wrl", 0}};
  return r;
}

}  // namespace atlas::test
