#include "libatlas/pipeline/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

struct SceneFacts {
  double area = 0, unlit_area = 0, uniform_area = 0;  // scene units squared
  std::uint64_t textured_triangles = 0;
};

bool is_black(Vec3f v) {
  return v.x == 0 && v.y == 0 && v.z == 0;
}

SceneFacts gather_facts(const Scene& scene) {
  SceneFacts facts;
  for (std::size_t t = 0; t < scene.triangle_count(); ++t) {
    const std::uint32_t* v = &scene.indices[3 * t];
    const glm::dvec3 a = to_dvec(scene.positions[v[0]]);
    const double area = 0.5 * glm::length(glm::cross(to_dvec(scene.positions[v[1]]) - a,
                                                     to_dvec(scene.positions[v[2]]) - a));
    facts.area += area;
    const Material& material = scene.materials[scene.triangle_material[t]];
    const bool textured = material.texture >= 0 && !scene.texcoord_indices.empty();
    facts.textured_triangles += textured;
    if (!scene.lit()) continue;
    const Vec3f e0 = scene.illumination[v[0]];
    if (e0 != scene.illumination[v[1]] || e0 != scene.illumination[v[2]]) continue;
    if (is_black(e0)) {
      facts.unlit_area += area;
    } else if (!textured) {
      facts.uniform_area += area;
    }
  }
  return facts;
}

// As fine as the budget could hold if nothing were downsized and packing lost nothing, within the
// paper's 0.1 to 1 cm: finer would be sampled in vain, coarser would leave room unused.
double affordable_texel(double area_m2, const ExportOptions& options) {
  constexpr double kFinest = 0.001, kCoarsest = 0.01;  // metres
  const double room = double(options.atlases) * options.atlas_size * options.atlas_size;
  return std::clamp(std::sqrt(area_m2 / room), kFinest, kCoarsest);
}

std::string budget_text(const ExportOptions& options) {
  return fmt::format("{} page{} of {}²", options.atlases, options.atlases == 1 ? "" : "s",
                     options.atlas_size);
}

}  // namespace

bool ExportPlan::runs(const std::string& stage) const {
  const auto step =
      std::find_if(steps.begin(), steps.end(), [&](const PlanStep& s) { return s.stage == stage; });
  return step != steps.end() && step->run;
}

ExportPlan make_plan(const Scene& scene, const ExportOptions& options) {
  const SceneFacts facts = gather_facts(scene);
  ExportPlan plan;
  const double metres = scene.metres_per_unit;
  plan.surface_area_m2 = facts.area * metres * metres;
  plan.texel_metres = options.texel_metres > 0 ? options.texel_metres
                                               : affordable_texel(plan.surface_area_m2, options);
  plan.estimated_texels = plan.surface_area_m2 / (plan.texel_metres * plan.texel_metres);
  plan.unlit_share = facts.area > 0 ? facts.unlit_area / facts.area : 0;
  plan.uniform_share = facts.area > 0 ? facts.uniform_area / facts.area : 0;
  plan.bake = scene.lit() && !options.charts_only;
  plan.sample_reflectance =
      plan.bake && facts.textured_triangles > 0 && options.quantity == Quantity::illuminance;
  plan.simplify = plan.bake && options.simplify;

  const auto step = [&](std::string stage, bool run, std::string reason) {
    plan.steps.push_back({std::move(stage), run, std::move(reason)});
  };
  const std::string limit =
      options.charts.cone_degrees > 0
          ? fmt::format("normals within {:g}° of a chart's axis: planar stretch at most {:.3f}",
                        options.charts.cone_degrees,
                        1 / std::cos(options.charts.cone_degrees * M_PI / 180))
          : fmt::format(
                "stretch at most {:g} over 99.9 % of a chart; the solver runs only for "
                "charts that a planar projection would stretch more",
                options.charts.max_stretch);
  step("charts", true, limit);
  step("exposure", plan.bake,
       plan.bake     ? fmt::format("{} tone curve, {}", tone_operator_name(options.tone.op),
                               options.tone.white > 0 ? "white given" : "white measured")
       : scene.lit() ? "charts only were asked for"
                     : "the scene carries no illumination: plain uvs, no images");
  step("reflectance", plan.sample_reflectance,
       !plan.bake                                ? "no light to bake"
       : options.quantity == Quantity::luminance ? "the values are luminance already"
       : facts.textured_triangles == 0
           ? "no textures: one colour a material"
           : fmt::format("{} textured triangles", facts.textured_triangles));
  step("tiling", plan.bake,
       plan.bake
           ? "charts longer than half a page are cut, so that none holds the others' scale down"
           : "no light to bake");
  const bool downsize = plan.bake && options.threshold > 0;
  step("downsizing", downsize,
       !plan.bake ? "no light to bake"
       : !downsize
           ? "the threshold is 0"
           : fmt::format("threshold {:.4f}; {:.0f} % of the surface is unlit and {:.0f} % "
                         "of one colour: smallest textures without sampling",
                         options.threshold, 100 * plan.unlit_share, 100 * plan.uniform_share));
  const double capacity = double(options.atlases) * options.atlas_size * options.atlas_size;
  const bool group = !options.charts_only && options.atlases > 1;
  step("grouping", group,
       group
           ? fmt::format("about {:.1f} M texels of {:.2g} mm before downsizing into {}; no "
                         "bisection if the pages' own area already gives as few groups",
                         plan.estimated_texels / 1e6, 1e3 * plan.texel_metres, budget_text(options))
           : "one page");
  step("packing", true,
       fmt::format("{}, {:.1f} M texels of room", budget_text(options), capacity / 1e6));
  step("baking", plan.bake,
       plan.bake ? fmt::format("{} shifted grids, gutters for mip levels 0 to {}", options.shifts,
                               options.mip_levels)
                 : "no light to bake");
  step("simplify", plan.simplify,
       plan.simplify
           ? fmt::format("surface and texture slip at most {:g} texels", options.simplify_slip)
       : !options.simplify ? "switched off"
                           : "without baked light the fine mesh is the result");
  step("error", plan.bake && options.measure_error,
       plan.bake && options.measure_error ? "100000 points of the surface against the pages"
                                          : "no baked light to measure");
  return plan;
}

}  // namespace atlas
