// Internal: stage 2 of an export, which sizes the textures for the pages that there are.
#pragma once

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/pipeline/longest_sides.h"
#include "libatlas/report/export_report.h"
#include "libatlas/texture/chart_textures.h"

namespace atlas {

struct SizedTextures {
  TextureResult textures;
  double sizing = 1;  // factor of the densities asked for at which they are sized (sizing_factor)
};

// Sizes the textures of all charts. Errors: no_solution if the pages cannot hold the charts even
// with the smallest textures; those of wanted_densities() and size_chart_textures().
Result<SizedTextures> size_textures(const ChartLight& light, const PageBudget& budget,
                                    const Context& context);

// Fills the report's part on textures.
void report_textures(const TextureResult& textures, ExportReport& report);

}  // namespace atlas
