// Derives advice for the user from the figures of a finished export.
#pragma once

#include <string>
#include <vector>

#include "libatlas/pipeline/export_options.h"
#include "libatlas/report/export_report.h"
#include "libatlas/scene/scene.h"

namespace atlas {

// Returns one line for each problem: what it is, what it means, and which options change it. Most
// scenes have none.
std::vector<std::string> advice_on(const ExportReport& report, const ExportOptions& options);

// Returns lines on properties of materials that baked pages do not have: that they are transparent
// or have holes, and, unless the quantity already includes it, that they emit light.
std::vector<std::string> advice_on_materials(const Scene& scene, Quantity quantity);

// Returns a line if triangles have no light at any corner, because their vertices lack what others
// of the scene have: such values may be paint rather than light.
std::vector<std::string> advice_on_missing_light(const Scene& scene, const DefectReport& defects,
                                                 const ExportOptions& options);

}  // namespace atlas
