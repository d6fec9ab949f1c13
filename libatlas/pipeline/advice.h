// What the figures of a finished export should make its user think of.
#pragma once

#include <string>
#include <vector>

#include "libatlas/pipeline/export_options.h"
#include "libatlas/report/export_report.h"

namespace atlas {

// One line each: what is so, what it means, and which options change it. Empty for most scenes.
std::vector<std::string> advice_on(const ExportReport& report, const ExportOptions& options);

}  // namespace atlas
