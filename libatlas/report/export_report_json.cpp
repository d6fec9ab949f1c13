#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libatlas/files/atomic_file.h"
#include "libatlas/report/export_report.h"
#include "libatlas/report/report_json.h"

namespace atlas {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMebibyte = 1024.0 * 1024.0;

// JSON has no infinities, so they are written as null.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json json_of(const Distortion& d) {
  return {{"stretch_l2", d.stretch_l2},
          {"stretch_linf", number(d.stretch_linf)},
          {"stretch_999", d.stretch_999},
          {"conformal_mean", d.conformal_mean},
          {"conformal_max", number(d.conformal_max)},
          {"area_min", d.area_min},
          {"area_max", number(d.area_max)},
          {"flips", d.flips},
          {"degenerate", d.degenerate}};
}

Json scene_json(const ExportReport& r) {
  Json defects = Json::array();
  for (const Defect& defect : r.defects.defects) {
    defects.push_back({{"kind", name_of(defect.kind)},
                       {"meaning", describe(defect.kind)},
                       {"count", defect.count},
                       {"first", defect.first_places}});
  }
  return {{"file", r.scene.string()},
          {"triangles", r.triangles},
          {"vertices", r.vertices},
          {"objects", r.objects},
          {"materials", r.materials},
          {"textures", r.textures},
          {"lit", r.lit},
          {"metres_per_unit", r.metres_per_unit},
          {"origin", {r.origin.x, r.origin.y, r.origin.z}},
          {"triangles_left_out", r.defects.triangles_left_out},
          {"defects", defects}};
}

Json json_of(const ExportPlan& plan) {
  Json steps = Json::array();
  for (const PlanStep& step : plan.steps)
    steps.push_back({{"stage", step.stage}, {"run", step.run}, {"reason", step.reason}});
  return {{"surface_area_m2", plan.surface_area_m2},
          {"texel_m", plan.texel_metres},
          {"estimated_texels", plan.estimated_texels},
          {"unlit_share", plan.unlit_share},
          {"uniform_share", plan.uniform_share},
          {"light_spacing_m", plan.light_spacing_m},
          {"steps", steps}};
}

Json skipped_json(const ExportPlan& plan) {
  Json skipped = Json::array();
  for (const PlanStep& step : plan.steps)
    if (!step.run) skipped.push_back({{"stage", step.stage}, {"reason", step.reason}});
  return skipped;
}

Json stages_json(const ExportReport& r) {
  Json stages = Json::array();
  for (const StageReport& s : r.stages) {
    stages.push_back({{"stage", s.stage},
                      {"wall_ms", 1e3 * s.wall_seconds},
                      {"cpu_ms", 1e3 * s.cpu_seconds},
                      {"peak_mib", double(s.peak_memory) / kMebibyte},
                      {"in", s.size_in},
                      {"out", s.size_out},
                      {"unit", s.unit},
                      {"quality", s.quality}});
  }
  return stages;
}

Json json_of(const ChartSet::Timing& t) {
  return {{"topology", t.topology_cpu}, {"noise", t.noise_cpu},     {"cells", t.cells_cpu},
          {"coarse", t.coarse_cpu},     {"merging", t.merging_cpu}, {"borders", t.borders_cpu},
          {"cuts", t.cuts_cpu},         {"solve", t.solve_cpu},     {"flips", t.flips_cpu},
          {"overlaps", t.overlaps_cpu}, {"absorb", t.absorb_cpu},   {"limbs", t.limbs_cpu}};
}

constexpr std::array kOrigins{ChartOrigin::kept, ChartOrigin::repaired, ChartOrigin::made};

const char* name_of(ChartOrigin origin) {
  return origin == ChartOrigin::kept ? "kept" : origin == ChartOrigin::made ? "made" : "repaired";
}

// How many charts have what of the earlier uvs.
Json origins_json(const ExportReport& r) {
  Json json;
  for (const ChartOrigin origin : kOrigins)
    json[name_of(origin)] = std::count(r.origins.begin(), r.origins.end(), origin);
  return json;
}

Json rows_of(const ExportReport& r) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < r.charts.size(); ++i) {
    const Chart& c = r.charts[i];
    rows.push_back({{"triangles", c.triangle_count},
                    {"size", {c.size.x, c.size.y}},
                    {"area", c.distortion.surface_area},
                    {"cone_degrees", c.cone_degrees},
                    {"planar", c.planar_projection},
                    {"kept", c.kept},
                    {"distortion", json_of(c.distortion)}});
    if (i < r.origins.size()) rows.back()["origin"] = name_of(r.origins[i]);
    if (i >= r.chart_pages.size()) continue;
    rows.back()["page"] = r.chart_pages[i];
    rows.back()["texels_per_unit"] = r.chart_densities[i];
  }
  return rows;
}

Json charts_json(const ExportReport& r) {
  std::uint64_t planar = 0;
  double widest_cone = 0;
  for (const Chart& c : r.charts) {
    planar += c.planar_projection;
    widest_cone = std::max(widest_cone, c.cone_degrees);
  }
  return {
      {"count", r.charts.size()},
      {"planar", planar},
      {"widest_cone_degrees", widest_cone},
      {"distortion", json_of(r.distortion)},
      {"written_stretch_999", r.written_stretch_999},
      {"beyond_bound", r.charts_beyond_bound},
      {"seam_length", r.seam_length},
      {"seam_per_root_area", r.surface_area > 0 ? r.seam_length / std::sqrt(r.surface_area) : 0},
      {"surface_area", r.surface_area},
      {"segmentation_cpu_s", r.chart_timing.segmentation_cpu},
      {"parameterization_cpu_s", r.chart_timing.parameterization_cpu},
      {"cpu_parts_s", json_of(r.chart_timing)},
      {"repairs",
       {{"degenerate_triangles", r.repairs.degenerate_triangles},
        {"duplicate_triangles", r.repairs.duplicate_triangles},
        {"nonmanifold_edges", r.repairs.nonmanifold_edges},
        {"nonmanifold_vertices", r.repairs.nonmanifold_vertices},
        {"misoriented_edges", r.repairs.misoriented_edges},
        {"split_charts", r.repairs.split_charts},
        {"kept_charts", r.repairs.kept_charts},
        {"reflattened_charts", r.repairs.reflattened_charts}}}};
}

Json light_json(const ExportReport& r) {
  return {{"tone", tone_operator_name(r.tone.op)},
          {"white", r.exposure_white},
          {"median", r.luminance.median},
          {"middle", r.luminance.middle},
          {"percentile98", r.luminance.percentile98},
          {"percentile99", r.luminance.percentile99},
          {"maximum", r.luminance.maximum},
          {"mean", r.luminance.mean},
          {"log_average", r.luminance.log_average},
          {"lit_area", r.luminance.lit_area},
          {"unlit_area", r.luminance.unlit_area},
          {"seam_length", r.light_seam_length},
          {"not_finite", r.luminance.not_finite},
          {"negative", r.luminance.negative}};
}

Json textures_json(const ExportReport& r) {
  return {
      {"texel", r.texel},
      {"packed_texel", r.packed_texel},
      {"full_texels", r.full_texels},
      {"final_texels", r.final_texels},
      {"saved_share", r.full_texels > 0 ? 1 - double(r.final_texels) / double(r.full_texels) : 0},
      {"halved_charts", r.halved_charts},
      {"uniform_charts", r.uniform_charts},
      {"unlit_charts", r.unlit_charts},
      {"capped_charts", r.capped_charts},
      {"raised_charts", r.raised_charts},
      {"sampled_charts", r.sampled_charts},
      {"sampled_texels", r.sampled_texels},
      {"rms_error", r.downsizing_rms},
      {"max_error", r.downsizing_max}};
}

Json grouping_json(const GroupingResult& g) {
  Json trace = Json::array();
  for (const GroupingStep& step : g.trace) trace.push_back({step.capacity, step.groups});
  return {{"groups", g.group_count},
          {"capacity", g.capacity},
          {"largest_group", g.largest_group},
          {"imbalance", g.imbalance},
          {"lower_bound", g.lower_bound},
          {"upper_bound", g.upper_bound},
          {"group_sizes", g.group_size},
          {"proved_smallest", g.proved_smallest},
          {"trace", trace}};
}

Json pages_json(const ExportReport& r) {
  Json pages = Json::array();
  for (const PageReport& p : r.pages) {
    const Json psnr = p.compression_psnr ? Json(*p.compression_psnr) : Json();
    pages.push_back({{"image", p.image},
                     {"width", p.width},
                     {"height", p.height},
                     {"charts", p.charts},
                     {"bytes", p.image_bytes},
                     {"compression_psnr", psnr}});
  }
  Json packing{{"scale", r.scale},
               {"outlines", r.outlines},
               {"uv_utilization", r.uv_utilization},
               {"least_side_share", r.least_side_share},
               {"opened_charts", r.opened_charts},
               {"own_scales", r.own_scales}};
  if (r.gaps) {
    packing["border_texels"] = r.gaps->border;
    packing["shared_border_texels"] = r.gaps->near_after;
  }
  packing["mip_levels"] = r.mip_levels;
  packing["gpu_bytes"] = r.gpu_bytes;
  packing["thin_triangles"] = r.thin_triangles;
  packing["cut_polygons"] = r.cut_polygons;
  if (r.texels_drawn_twice) packing["texels_drawn_twice"] = *r.texels_drawn_twice;
  packing["pages"] = pages;
  return packing;
}

// A value that no sample determines is written as null, because a 0 would read as a perfect or a
// hopeless result. So is the PSNR of samples without any error.
Json error_json(const Fidelity& f, ToneOperator tone) {
  const bool inverted = tone == ToneOperator::linear && f.lit > f.clipped;
  const auto decibels = [](double value, std::uint64_t samples) {
    return samples > 0 && value < kPerfectDecibels ? Json(value) : Json(nullptr);
  };
  Json worst = Json::array();
  for (const WorstPlace& place : f.worst)
    worst.push_back({{"page", place.page},
                     {"texel", {place.texel.x, place.texel.y}},
                     {"wanted", {place.wanted.x, place.wanted.y, place.wanted.z}},
                     {"shown", {place.shown.x, place.shown.y, place.shown.z}},
                     {"error", place.error}});
  const auto of_lit = [&](double value) { return f.lit > 0 ? Json(value) : Json(nullptr); };
  return {{"samples_lit", f.lit},
          {"samples_unlit", f.unlit},
          {"samples_clipped", f.clipped},
          {"samples_unplaced", f.unplaced},
          {"rmse", inverted ? Json(f.rmse) : Json(nullptr)},
          {"psnr", decibels(f.psnr, f.lit)},
          {"psnr_rgb",
           {decibels(f.psnr_channel[0], f.lit), decibels(f.psnr_channel[1], f.lit),
            decibels(f.psnr_channel[2], f.lit)}},
          {"psnr_with_unlit", decibels(f.psnr_all, f.lit + f.unlit)},
          {"rmse_display", of_lit(f.rmse_display)},
          {"p95", of_lit(f.p95)},
          {"p999", of_lit(f.p999)},
          {"max", of_lit(f.maximum)},
          {"worst", worst}};
}

// Values that were not measured have no key, because a 0 would read as a perfect result.
void add_results(const ExportReport& r, const ReportRequest& request, Json& json) {
  json["charts"] = charts_json(r);
  if (!r.origins.empty()) json["charts"]["like"] = origins_json(r);
  if (request.chart_rows) json["charts"]["charts"] = rows_of(r);
  json["packing"] = pages_json(r);
  if (r.plan.runs("grouping")) json["grouping"] = grouping_json(r.grouping);
  if (r.full_texels > 0) {
    json["light"] = light_json(r);
    json["textures"] = textures_json(r);
  }
  if (r.simplified) {
    json["simplify"] = {{"triangles_in", r.triangles},
                        {"triangles_out", r.triangles_out},
                        {"slip_texels", r.slip_texels},
                        {"turn_degrees", r.turn_degrees}};
  }
  if (r.error_measured) json["error"] = error_json(r.fidelity, r.tone.op);
  Json files = Json::array();
  for (const auto& [name, bytes] : r.files) files.push_back({{"file", name}, {"bytes", bytes}});
  json["files"] = files;
  json["not_kept"] = r.not_kept;
  json["advice"] = r.advice;
}

}  // namespace

nlohmann::ordered_json json_of(const ExportReport& r, const ReportRequest& request) {
  Json json{{"version", LIBATLAS_VERSION}};
  if (!request.command.empty()) json["command"] = request.command;
  for (const auto& [name, value] : request.options) json["options"][name] = value;
  json.update({{"target", r.target.string()},
               {"wall_s", r.wall_seconds},
               {"cpu_s", r.cpu_seconds},
               {"peak_mib", double(r.peak_memory) / kMebibyte},
               {"scene", scene_json(r)},
               {"plan", json_of(r.plan)},
               {"stages", stages_json(r)},
               {"skipped", skipped_json(r.plan)}});
  if (r.carried_out) add_results(r, request, json);
  return json;
}

Status write_json(const ExportReport& r, const std::filesystem::path& path,
                  const ReportRequest& request) {
  // Names come from files and may hold bytes that are not UTF-8. Such bytes are replaced, because
  // otherwise they would end the export.
  return write_file(path,
                    json_of(r, request).dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

std::string stage_line(const StageReport& s) {
  return fmt::format("{:<11} {:>9} {} {:<9} {:<44} {:7.2f} s {:6.0f} MiB", s.stage, s.size_in, "->",
                     s.size_out, s.unit + (s.quality.empty() ? "" : ", " + s.quality),
                     s.cpu_seconds, double(s.peak_memory) / kMebibyte);
}

}  // namespace atlas
