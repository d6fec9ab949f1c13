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

// Lines on what materials have and baked pages have not: that they are seen through or have holes,
// and, unless the quantity holds it already, light of their own.
std::vector<std::string> advice_on_materials(const Scene& scene, Quantity quantity);

}  // namespace atlas
