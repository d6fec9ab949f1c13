// Internal: the report as JSON, for the file and for the page.
#pragma once

#include <nlohmann/json.hpp>

#include "libatlas/report/export_report.h"

namespace atlas {

nlohmann::ordered_json json_of(const ExportReport& report, const ReportRequest& request);

}  // namespace atlas
