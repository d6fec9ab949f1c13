// What will be done for this scene, and what it does not need: decided before any work is done.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libatlas/pipeline/export_options.h"
#include "libatlas/scene/scene.h"

namespace atlas {

struct PlanStep {
  std::string stage;
  bool run = true;
  std::string reason;  // why it runs or is skipped, with the numbers it follows from
};

struct ExportPlan {
  std::vector<PlanStep> steps;
  double surface_area_m2 = 0;
  double texel_metres = 0;         // ExportOptions::texel_metres, or what was chosen for it
  double estimated_texels = 0;     // at texel_metres, before downsizing
  double unlit_share = 0;          // of the area, triangles whose corners are all exactly black
  double uniform_share = 0;        // of the area, triangles whose corners are all equal and lit
  bool bake = true;                // there is light to bake
  bool sample_reflectance = true;  // textures take part
  bool simplify = true;

  bool runs(const std::string& stage) const;
};

// Linear in the number of triangles, a small share of reading the file.
ExportPlan make_plan(const Scene& scene, const ExportOptions& options);

// What would else be found out after minutes: texels larger than the scene, files that could not
// be written. Errors: bad_input, bad_option, io.
Status check_plan(const ExportPlan& plan, const ExportOptions& options);

}  // namespace atlas
