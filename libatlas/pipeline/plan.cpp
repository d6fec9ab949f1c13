#include "libatlas/pipeline/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libatlas/core/counted.h"
#include "libatlas/core/degrees.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/exporters/world.h"
#include "libatlas/files/atomic_file.h"
#include "libatlas/pipeline/lightmap.h"
#include "libatlas/scene/triangle_area.h"
#include "libatlas/texture/luminance.h"
#include "libatlas/uvs/placement.h"

namespace atlas {
namespace {

struct SceneFacts {
  double area = 0, unlit_area = 0, uniform_area = 0;  // scene units squared
  std::uint64_t textured_triangles = 0;
  double varied_edges = 0;             // mean length of the edges of varied triangles, scene units
  std::uint64_t varied_triangles = 0;  // those whose corners are not lit alike
};

bool is_black(Vec3f v) {
  return v.x == 0 && v.y == 0 && v.z == 0;
}

double mean_edge(const Scene& scene, const std::uint32_t* v) {
  double sum = 0;
  for (int k = 0; k < 3; ++k)
    sum += glm::length(to_dvec(scene.positions[v[(k + 1) % 3]]) - to_dvec(scene.positions[v[k]]));
  return sum / 3;
}

SceneFacts gather_facts(const Scene& scene) {
  SceneFacts facts;
  double edges = 0;
  for (std::size_t t = 0; t < scene.triangle_count(); ++t) {
    const std::uint32_t* v = &scene.indices[3 * t];
    const double area = triangle_area(scene, t);
    facts.area += area;
    const Material& material = scene.materials[scene.triangle_material[t]];
    const bool textured = material.texture >= 0 && !scene.texcoord_indices.empty();
    facts.textured_triangles += textured;
    if (!scene.lit()) continue;
    const Vec3f e0 = scene.illumination[v[0]];
    if (e0 != scene.illumination[v[1]] || e0 != scene.illumination[v[2]]) {
      edges += mean_edge(scene, v);
      ++facts.varied_triangles;
      continue;
    }
    if (is_black(e0)) {
      facts.unlit_area += area;
    } else if (!textured) {
      facts.uniform_area += area;
    }
  }
  if (facts.varied_triangles > 0) facts.varied_edges = edges / double(facts.varied_triangles);
  return facts;
}

// Returns the texel length, in metres, at which the texels would just fill the budget if nothing
// were downsized and packing lost nothing. Finer texels would be sampled in vain, and coarser ones
// would leave room unused. The length is kept within the paper's 0.1 to 1 cm, which suits rooms,
// except that a scene of centimetres gets 64 texels across, and a scan whose vertices lie closer
// gets what they carry. With four texels to an edge, pages reproduce noise that changes from vertex
// to vertex to 45 dB; with two, to 36 dB.
double affordable_texel(const ExportPlan& plan, const ExportOptions& options) {
  constexpr double kFinest = 0.001, kCoarsest = 0.01, kTexelsAnEdge = 4;  // metres, metres
  const double room = double(options.atlases) * options.atlas_size * options.atlas_size;
  double finest = kFinest;
  if (plan.surface_area_m2 > 0) finest = std::min(finest, std::sqrt(plan.surface_area_m2) / 64);
  if (plan.light_spacing_m > 0) finest = std::min(finest, plan.light_spacing_m / kTexelsAnEdge);
  return std::clamp(std::sqrt(plan.surface_area_m2 / room), finest, kCoarsest);
}

// Estimates the texels of the whole surface before downsizing. They are finer where a diffuse
// texture is.
double estimate_texels(const Scene& scene, const ExportPlan& plan, const ExportOptions& options) {
  const double base = scene.metres_per_unit / plan.texel_metres;  // texels per unit of length
  if (!plan.sample_reflectance || !options.follow_textures)
    return plan.surface_area_m2 / (plan.texel_metres * plan.texel_metres);
  const double sampling = texture_sampling(options);
  double texels = 0;
  for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
    const double density = std::max(base, sampling * texture_density(scene, t));
    texels += triangle_area(scene, t) * density * density;
  }
  return texels;
}

std::string budget_text(std::uint32_t pages, std::int32_t side) {
  return fmt::format("{} of {}²", counted(pages, "page"), side);
}

std::string charts_reason(const ChartOptions& charts) {
  if (charts.keep_uv_charts) {
    ChartOptions anew = charts;
    anew.keep_uv_charts = false;
    return "given charts keep their shape, whatever it stretches; the others: " +
           charts_reason(anew);
  }
  if (charts.cone_degrees > 0) {
    const std::string cone =
        fmt::format("normals within {:g}° of a chart's axis", charts.cone_degrees);
    if (charts.cone_degrees >= 90) return cone;  // a projection may stretch without limit
    return fmt::format("{}: planar stretch at most {:.3f}", cone,
                       1 / cosine_of(charts.cone_degrees));
  }
  return fmt::format(
      "stretch at most {:g} over 99.9 % of a chart; the solver runs only for charts that a planar "
      "projection would stretch more",
      charts.max_stretch);
}

// Lists the plan's steps in the order of the pipeline, each with its reason for this scene.
class StepList {
 public:
  StepList(const Scene& scene, const ExportOptions& options, ExportPlan& plan)
      : scene_(scene), options_(options), plan_(plan) {}

  void make(std::uint64_t textured_triangles) {
    exposure();
    add("charts", true, charts_reason(options_.charts));
    light(textured_triangles);
    pages();
    result();
  }

 private:
  void add(std::string stage, bool run, std::string reason) {
    plan_.steps.push_back({std::move(stage), run, std::move(reason)});
  }

  // Adds a step that only baked light needs.
  void add_baked(std::string stage, bool run, std::string reason) {
    add(std::move(stage), plan_.bake && run, plan_.bake ? std::move(reason) : "no light to bake");
  }

  void exposure() {
    add("exposure", plan_.bake,
        plan_.bake     ? fmt::format("{} tone curve, {}", tone_operator_name(options_.tone.op),
                                 options_.tone.white > 0                 ? "white given"
                                     : options_.quantity == Quantity::colour ? "white at 1"
                                                                             : "white measured")
        : scene_.lit() ? "charts only were asked for"
                       : "the scene carries no illumination: plain uvs, no images");
  }

  void light(std::uint64_t textured_triangles) {
    add_baked("reflectance", plan_.sample_reflectance,
              options_.keep_scene ? "a lightmap holds the light that falls on surfaces"
              : options_.quantity == Quantity::luminance ? "the values are luminance already"
              : options_.quantity == Quantity::colour    ? "the values are colours already"
              : textured_triangles == 0                  ? "no textures: one colour a material"
                                        : fmt::format("{} textured triangles", textured_triangles));
    add_baked("tiling", true,
              "charts longer than half a page are cut, so that none holds the others' scale down");
    add_baked(
        "downsizing", options_.threshold > 0,
        options_.threshold > 0
            ? fmt::format("threshold {:.4f}; {:.0f} % of the surface is unlit and {:.0f} % "
                          "of one colour: smallest textures without sampling",
                          options_.threshold, 100 * plan_.unlit_share, 100 * plan_.uniform_share)
            : "the threshold is 0");
  }

  void pages() {
    const std::uint32_t pages = plan_.bake ? options_.atlases : options_.plain_pages;
    const double capacity = double(pages) * options_.atlas_size * options_.atlas_size;
    const bool group = pages > 1;
    const std::string budget = budget_text(pages, options_.atlas_size);
    const double texel = plan_.texel_metres;
    const bool raised = plan_.estimated_texels > 1.001 * plan_.surface_area_m2 / (texel * texel);
    add("grouping", group,
        group ? fmt::format("about {:.1f} M texels of {:.2g} mm{} before downsizing into {}; "
                            "fewer pages if these hold all charts at full size",
                            plan_.estimated_texels / 1e6, 1e3 * texel,
                            raised ? ", finer where diffuse textures are," : "", budget)
              : "one page");
    add("packing", true, fmt::format("{}, {:.1f} M texels of room", budget, capacity / 1e6));
    add_baked("baking", true,
              fmt::format("{} shifted grids, gutters for mip levels 0 to {}{}", options_.shifts,
                          options_.mip_levels,
                          options_.more_mip_levels && options_.mip_levels < kMostMipLevels
                              ? ", or more where pages have room"
                              : ""));
  }

  void result() {
    add("simplify", plan_.simplify,
        plan_.simplify
            ? fmt::format("surface and texture slip at most {:g} texels", options_.simplify_slip)
        : plan_.bake && options_.keep_scene ? "the scene is kept"
        : !options_.simplify                ? "switched off"
                                            : "without baked light the fine mesh is the result");
    add_baked(
        "error", options_.measure_error,
        options_.measure_error ? "100000 points of the surface against the pages" : "switched off");
  }

  const Scene& scene_;
  const ExportOptions& options_;
  ExportPlan& plan_;
};

}  // namespace

ToneOptions tone_options(const ExportOptions& options) {
  ToneOptions tone = options.tone;
  // Colours are to look as they are: a measured white would brighten a dark scan.
  if (options.quantity == Quantity::colour && tone.white <= 0) tone.white = 1;
  return tone;
}

double texture_sampling(const ExportOptions& options) {
  // If the user gives a texel length, the diffuse texture's density is kept (the paper's rule).
  // Otherwise it is exceeded where the budget allows that, because a texture that is sampled at its
  // own density becomes blurred.
  constexpr double kExceeding = 1.5;
  return options.texel_metres > 0 ? 1 : kExceeding;
}

TextureOptions texture_options(const ExportPlan& plan, const ExportReport& report,
                               const ExportOptions& options) {
  TextureOptions texture;
  texture.texel = plan.texel_metres / report.metres_per_unit;
  texture.follow_textures = options.follow_textures;
  texture.texture_sampling = texture_sampling(options);
  texture.threshold = options.threshold;
  if (options.exr || options.linear) texture.brightest = report.luminance.maximum;
  texture.min_side = options.min_side;
  texture.max_side = options.atlas_size - 2 * gutter_pad(options.mip_levels);
  return texture;
}

ExportOptions planned_options(const Scene& scene, const ExportOptions& options) {
  ExportOptions planned = options;
  planned.charts_only |= keeps_paint(scene, options);
  if (!has_lightmap(scene.lit(), planned)) return planned;
  planned.atlases = options.lightmap_pages;
  planned.simplify = false;
  if (options.quantity == Quantity::illuminance) planned.quantity = Quantity::luminance;
  return planned;
}

ExportPlan make_plan(const Scene& scene, const ExportOptions& asked) {
  const ExportOptions options = planned_options(scene, asked);
  const SceneFacts facts = gather_facts(scene);
  ExportPlan plan;
  const double metres = scene.metres_per_unit;
  plan.surface_area_m2 = facts.area * metres * metres;
  plan.light_spacing_m = facts.varied_edges * metres;
  plan.texel_metres =
      options.texel_metres > 0 ? options.texel_metres : affordable_texel(plan, options);
  plan.unlit_share = facts.area > 0 ? facts.unlit_area / facts.area : 0;
  plan.uniform_share = facts.area > 0 ? facts.uniform_area / facts.area : 0;
  plan.bake = scene.lit() && !options.charts_only;
  plan.sample_reflectance =
      plan.bake && facts.textured_triangles > 0 && options.quantity == Quantity::illuminance;
  plan.simplify = plan.bake && options.simplify;
  plan.estimated_texels = estimate_texels(scene, plan, options);

  StepList(scene, options, plan).make(facts.textured_triangles);
  return plan;
}

ExportReport planned_report(const LoadedScene& loaded, const ExportPlan& plan,
                            const ExportOptions& options) {
  const Scene& scene = loaded.scene;
  ExportReport report;
  report.target = options.target;
  report.triangles = scene.triangle_count();
  report.vertices = scene.positions.size();
  report.materials = scene.materials.size();
  report.textures = scene.textures.size();
  report.objects = scene.object_names.size();
  report.lit = scene.lit();
  report.metres_per_unit = scene.metres_per_unit;
  report.origin = scene.origin;
  report.defects = loaded.defects;
  report.plan = plan;
  return report;
}

Status check_plan(const ExportPlan& plan, const ExportOptions& options) {
  const std::filesystem::path& target = options.target;
  if (options.udim && plan.bake) {
    return {ErrorCode::bad_option,
            "ExportOptions::udim: this scene carries light, whose pages are images with materials "
            "of their own (add ExportOptions::charts_only, or leave ExportOptions::udim out)"};
  }
  if (options.mesh_uvs != MeshUvs::places && plan.bake) {
    return {
        ErrorCode::bad_option,
        "ExportOptions::mesh_uvs: this scene carries light, and each place of a mesh has its own "
        "(add ExportOptions::charts_only, or leave ExportOptions::mesh_uvs out)"};
  }
  if (options.like && plan.bake) {
    return {ErrorCode::bad_option,
            "ExportOptions::like: this scene carries light, whose charts get textures of sizes of "
            "their own (add ExportOptions::charts_only, or leave ExportOptions::like out)"};
  }
  if (options.polygons && plan.bake) {
    return {ErrorCode::bad_option,
            "ExportOptions::polygons: this scene carries light, which is baked for triangles (add "
            "ExportOptions::charts_only, or leave ExportOptions::polygons out)"};
  }
  if ((plan.bake ? options.atlases : options.plain_pages) > 1 && !holds_pages(options, plan.bake)) {
    return plan.bake
               ? Status{ErrorCode::bad_option,
                        "ExportOptions::lightmap_pages: an .obj that keeps its scene has one page "
                        "for its light (write .gltf or .glb, or leave out "
                        "ExportOptions::lightmap_pages)"}
               : Status{ErrorCode::bad_option,
                        "ExportOptions::keep_scene: a scene that is kept has uvs without light on "
                        "one page (leave out ExportOptions::plain_pages, or add "
                        "ExportOptions::udim)"};
  }
  for (const ExtraFile& file : options.extra_files)
    if (Status s = check_writable(file.path); !s.ok()) return s;
  if (!options.false_colour.empty()) {
    if (!plan.bake)
      return {ErrorCode::bad_option,
              "ExportOptions::false_colour: there is no light to draw (leave it out)"};
    if (Status s = check_writable(options.false_colour); !s.ok()) return s;
  }
  if (!target.empty()) {
    if (Status s = check_writable(target); !s.ok() || !plan.bake) return s;
    const std::string last_page =
        page_name(target, options.atlases - 1) + page_extension(options.texture_format);
    if (Status s = check_writable(target.parent_path() / last_page); !s.ok()) return s;
  }
  if (!plan.bake && options.texel_metres == 0) return {};
  // A chart smaller than a texel has no place on a page.
  const double across = std::sqrt(plan.surface_area_m2);
  if (plan.texel_metres <= across) return {};
  if (!(across > 0) && plan.bake)
    return {ErrorCode::bad_input, "no triangle has an area, nothing can be lit (check the scene)"};
  return {ErrorCode::bad_option,
          fmt::format("ExportOptions::texel_metres: {:g} m is more than the side of a square as "
                      "large as all surfaces, {:g} m (check ExportOptions::texel_metres "
                      "and ReadOptions::metres_per_unit)",
                      plan.texel_metres, across)};
}

}  // namespace atlas
