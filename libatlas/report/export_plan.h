// The plan of an export: which stages run for a scene and which it does not need, with the figures
// that decide it.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace atlas {

struct PlanStep {
  std::string stage = {};
  bool run = true;
  std::string reason = {};  // why the stage runs or is skipped, with the figures that decide it
};

struct ExportPlan {
  std::vector<PlanStep> steps = {};
  double surface_area_m2 = 0;
  double texel_metres = 0;  // ExportOptions::texel_metres, or the length chosen if that is 0
  // Mean length of the edges of triangles whose corners are lit differently, which tells how finely
  // the mesh samples its light, metres; 0 if there are none.
  double light_spacing_m = 0;
  // Before downsizing, with texels of texel_metres, or finer ones where textures ask for them.
  double estimated_texels = 0;
  double unlit_share = 0;  // share of the area whose triangles have exactly black corners only
  // Share of the area whose triangles are untextured and have three equally lit corners.
  double uniform_share = 0;
  bool bake = true;                // there is light to bake
  bool sample_reflectance = true;  // diffuse textures are sampled
  bool simplify = true;

  bool runs(std::string_view stage) const {
    return std::any_of(steps.begin(), steps.end(),
                       [&](const PlanStep& step) { return step.stage == stage && step.run; });
  }
};

}  // namespace atlas
