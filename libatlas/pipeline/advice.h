// What the figures of a finished export should make its user think of.
#pragma once

#include <string>
#include <vector>

#include "libatlas/pipeline/export_options.h"
#include "libatlas/report/export_report.h"
#include "libatlas/scene/scene.h"

namespace atlas {

// One line each: what is so, what it means, and which options change it. Empty for most scenes.
std::vector<std::string> advice_on(const ExportReport& report, const ExportOptions& options);

// A line on materials that are seen through or have holes, which baked pages have not; or empty.
std::string advice_on_transparency(const Scene& scene);

}  // namespace atlas
