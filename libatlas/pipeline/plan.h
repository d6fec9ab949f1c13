// What will be done for this scene, and what it does not need: decided before any work is done.
#pragma once

#include "libatlas/pipeline/export_options.h"
#include "libatlas/report/export_plan.h"
#include "libatlas/report/export_report.h"
#include "libatlas/scene/reader.h"

namespace atlas {

// Linear in the number of triangles, a small share of reading the file.
ExportPlan make_plan(const Scene& scene, const ExportOptions& options);

// How many texels along a side a diffuse texture's texel is given.
double texture_sampling(const ExportOptions& options);

// The report of an export that has not begun: it tells of the scene and of the plan.
ExportReport planned_report(const LoadedScene& loaded, const ExportPlan& plan,
                            const ExportOptions& options);

// What would else be found out after minutes: texels larger than the scene, files that could not
// be written. Errors: bad_input, bad_option, io.
Status check_plan(const ExportPlan& plan, const ExportOptions& options);

}  // namespace atlas
