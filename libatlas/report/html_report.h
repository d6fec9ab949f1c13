// The report of an export as a page to read.
#pragma once

#include <filesystem>

#include "libatlas/core/status.h"
#include "libatlas/report/export_report.h"

namespace atlas {

// Writes a self-contained page of HTML: the figures of write_json(), charts of them, and the
// pictures of ExportReport::pictures, if they were made. It needs no network. The file is written
// completely or not at all. Errors: io; bad_input (a picture that WebP does not hold).
Status write_html(const ExportReport& report, const ReportRequest& request,
                  const std::filesystem::path& path);

}  // namespace atlas
