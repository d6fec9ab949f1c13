// What will be done for a scene, and what it does not need, with the figures that decided it.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

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
  double estimated_texels = 0;     // before downsizing: at texel_metres, or as textures ask for
  double unlit_share = 0;          // of the area, triangles whose corners are all exactly black
  double uniform_share = 0;        // of the area, triangles whose corners are all equal and lit
  bool bake = true;                // there is light to bake
  bool sample_reflectance = true;  // textures take part
  bool simplify = true;

  bool runs(std::string_view stage) const {
    return std::any_of(steps.begin(), steps.end(),
                       [&](const PlanStep& step) { return step.stage == stage && step.run; });
  }
};

}  // namespace atlas
