// Decides what is done for a scene and what the scene does not need, before any work is done.
#pragma once

#include "libatlas/pipeline/export_options.h"
#include "libatlas/report/export_plan.h"
#include "libatlas/report/export_report.h"
#include "libatlas/scene/reader.h"
#include "libatlas/texture/chart_textures.h"

namespace atlas {

// Returns the options that hold for this scene: a scene that is kept gets its light on one page, as
// it falls on the surfaces, and stays as fine as it is; if its colours are paint, it is one without
// light. All functions here take either.
ExportOptions planned_options(const Scene& scene, const ExportOptions& options);

// Makes the plan. This takes time in proportion to the number of triangles, a small share of what
// reading the file takes.
ExportPlan make_plan(const Scene& scene, const ExportOptions& options);

// Returns the tone curve's options for the quantity that the scene holds.
ToneOptions tone_options(const ExportOptions& options);

// Returns how many texels along a side the atlas has for each texel of a diffuse texture.
double texture_sampling(const ExportOptions& options);

// Returns the options of textures. The report tells the unit of length and, for pages that hold
// light above display white, the brightest light.
TextureOptions texture_options(const ExportPlan& plan, const ExportReport& report,
                               const ExportOptions& options);

// Returns the report of an export that has not begun. It describes the scene and the plan.
ExportReport planned_report(const LoadedScene& loaded, const ExportPlan& plan,
                            const ExportOptions& options);

// Finds errors that would otherwise show only after minutes: texels larger than the scene, and
// files that could not be written (none without ExportOptions::target). Errors: bad_input,
// bad_option, io.
Status check_plan(const ExportPlan& plan, const ExportOptions& options);

}  // namespace atlas
