// Reports for tests of advice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "libatlas/report/export_report.h"

namespace atlas::test {

// Returns the report of a baked export with so many charts on so many square pages.
inline ExportReport report_of(std::size_t charts, std::size_t pages, std::int32_t side) {
  ExportReport report;
  report.charts.resize(charts);
  report.pages.assign(pages, PageReport{"p.png", side, side, 1, 1});
  report.gpu_bytes = 1;
  report.uv_utilization = 0.7;
  return report;
}

// Returns whether there is one line of advice, which says this.
inline bool holds(const std::vector<std::string>& lines, const std::string& text) {
  return lines.size() == 1 && lines[0].find(text) != std::string::npos;
}

}  // namespace atlas::test
