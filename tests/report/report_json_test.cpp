// The JSON report: each key holds the figure that it names, and what was not measured has no key.
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

#include "libatlas/report/export_report.h"
#include "tests/report/written_report.h"

namespace atlas {
namespace {

using nlohmann::json;
using test::complete_report;
using test::written;

// A figure of a report, its place in the JSON, and the factor by which it is written.
struct Figure {
  const char* key;
  std::variant<double*, std::uint64_t*, std::int64_t*, std::uint32_t*, std::int32_t*> value;
  double factor = 1;
};

// Gives each figure another value, and expects every value where it belongs.
void expect_in_place(ExportReport& report, const std::vector<Figure>& figures) {
  int next = 100;
  for (const Figure& figure : figures) {
    std::visit([&](auto* value) { *value = std::remove_pointer_t<decltype(value)>(next++); },
               figure.value);
  }
  const json file = written(report);
  next = 100;
  for (const Figure& figure : figures) {
    const json::json_pointer place(figure.key);
    ASSERT_TRUE(file.contains(place)) << figure.key;
    EXPECT_NEAR(file[place].get<double>(), figure.factor * next++, 1e-9) << figure.key;
  }
}

constexpr double kPerMebibyte = 1.0 / (1 << 20);

TEST(ReportJson, FiguresOfTheExportAreInTheirPlaces) {
  ExportReport r = complete_report();
  StageReport& stage = r.stages[0];
  ExportPlan& plan = r.plan;
  expect_in_place(r, {{"/wall_s", &r.wall_seconds},
                      {"/cpu_s", &r.cpu_seconds},
                      {"/peak_mib", &r.peak_memory, kPerMebibyte},
                      {"/scene/triangles", &r.triangles},
                      {"/scene/vertices", &r.vertices},
                      {"/scene/objects", &r.objects},
                      {"/scene/materials", &r.materials},
                      {"/scene/textures", &r.textures},
                      {"/scene/metres_per_unit", &r.metres_per_unit},
                      {"/scene/origin/0", &r.origin.x},
                      {"/scene/origin/1", &r.origin.y},
                      {"/scene/origin/2", &r.origin.z},
                      {"/scene/triangles_left_out", &r.defects.triangles_left_out},
                      {"/plan/surface_area_m2", &plan.surface_area_m2},
                      {"/plan/texel_m", &plan.texel_metres},
                      {"/plan/estimated_texels", &plan.estimated_texels},
                      {"/plan/light_spacing_m", &plan.light_spacing_m},
                      {"/plan/unlit_share", &plan.unlit_share},
                      {"/plan/uniform_share", &plan.uniform_share},
                      {"/stages/0/wall_ms", &stage.wall_seconds, 1000},
                      {"/stages/0/cpu_ms", &stage.cpu_seconds, 1000},
                      {"/stages/0/peak_mib", &stage.peak_memory, kPerMebibyte},
                      {"/stages/0/in", &stage.size_in},
                      {"/stages/0/out", &stage.size_out},
                      {"/files/0/bytes", &r.files[0].second}});
  r.triangles = 7;
  expect_in_place(r, {{"/simplify/triangles_out", &r.triangles_out},
                      {"/simplify/slip_texels", &r.slip_texels},
                      {"/simplify/turn_degrees", &r.turn_degrees}});
  EXPECT_EQ(written(r)["simplify"]["triangles_in"], 7);
}

TEST(ReportJson, FiguresOfChartsAreInTheirPlaces) {
  ExportReport r = complete_report();
  const auto distortion = [](const std::string& at, Distortion& d, std::vector<std::string>& keys) {
    std::vector<Figure> figures;
    const std::vector<std::pair<const char*, decltype(Figure::value)>> all{
        {"stretch_l2", &d.stretch_l2},       {"stretch_linf", &d.stretch_linf},
        {"stretch_999", &d.stretch_999},     {"conformal_mean", &d.conformal_mean},
        {"conformal_max", &d.conformal_max}, {"area_min", &d.area_min},
        {"area_max", &d.area_max},           {"flips", &d.flips},
        {"degenerate", &d.degenerate}};
    for (const auto& [key, value] : all) keys.push_back(at + key);
    for (std::size_t i = 0; i < all.size(); ++i)
      figures.push_back({keys[keys.size() - all.size() + i].c_str(), all[i].second});
    return figures;
  };
  std::vector<std::string> keys;
  keys.reserve(18);  // so that their texts stay where they are
  expect_in_place(r, distortion("/charts/distortion/", r.distortion, keys));
  expect_in_place(r, distortion("/charts/charts/0/distortion/", r.charts[0].distortion, keys));

  ChartSet::Timing& t = r.chart_timing;
  ChartSet::Repairs& repairs = r.repairs;
  Chart& chart = r.charts[0];
  r.surface_area = 4;
  expect_in_place(r, {{"/charts/seam_length", &r.seam_length},
                      {"/charts/written_stretch_999", &r.written_stretch_999},
                      {"/charts/segmentation_cpu_s", &t.segmentation_cpu},
                      {"/charts/parameterization_cpu_s", &t.parameterization_cpu},
                      {"/charts/cpu_parts_s/topology", &t.topology_cpu},
                      {"/charts/cpu_parts_s/noise", &t.noise_cpu},
                      {"/charts/cpu_parts_s/cells", &t.cells_cpu},
                      {"/charts/cpu_parts_s/coarse", &t.coarse_cpu},
                      {"/charts/cpu_parts_s/merging", &t.merging_cpu},
                      {"/charts/cpu_parts_s/borders", &t.borders_cpu},
                      {"/charts/cpu_parts_s/cuts", &t.cuts_cpu},
                      {"/charts/cpu_parts_s/solve", &t.solve_cpu},
                      {"/charts/cpu_parts_s/flips", &t.flips_cpu},
                      {"/charts/cpu_parts_s/overlaps", &t.overlaps_cpu},
                      {"/charts/cpu_parts_s/absorb", &t.absorb_cpu},
                      {"/charts/cpu_parts_s/limbs", &t.limbs_cpu},
                      {"/charts/repairs/degenerate_triangles", &repairs.degenerate_triangles},
                      {"/charts/repairs/duplicate_triangles", &repairs.duplicate_triangles},
                      {"/charts/repairs/nonmanifold_edges", &repairs.nonmanifold_edges},
                      {"/charts/repairs/nonmanifold_vertices", &repairs.nonmanifold_vertices},
                      {"/charts/repairs/misoriented_edges", &repairs.misoriented_edges},
                      {"/charts/repairs/split_charts", &repairs.split_charts},
                      {"/charts/repairs/kept_charts", &repairs.kept_charts},
                      {"/charts/repairs/reflattened_charts", &repairs.reflattened_charts},
                      {"/charts/charts/0/triangles", &chart.triangle_count},
                      {"/charts/charts/0/size/0", &chart.size.x},
                      {"/charts/charts/0/size/1", &chart.size.y},
                      {"/charts/charts/0/area", &chart.distortion.surface_area},
                      {"/charts/charts/0/cone_degrees", &chart.cone_degrees}});
  const json charts = written(r)["charts"];
  EXPECT_EQ(charts["count"], 1);
  EXPECT_EQ(charts["surface_area"], 4);
  EXPECT_EQ(charts["seam_per_root_area"], r.seam_length / 2);
  EXPECT_EQ(charts["widest_cone_degrees"], chart.cone_degrees);
}

TEST(ReportJson, FiguresOfPagesAreInTheirPlaces) {
  ExportReport r = complete_report();
  GroupingResult& g = r.grouping;
  PageReport& page = r.pages[0];
  expect_in_place(r, {{"/packing/scale", &r.scale},
                      {"/packing/uv_utilization", &r.uv_utilization},
                      {"/packing/least_side_share", &r.least_side_share},
                      {"/packing/opened_charts", &r.opened_charts},
                      {"/packing/border_texels", &r.gaps->border},
                      {"/packing/shared_border_texels", &r.gaps->near_after},
                      {"/packing/mip_levels", &r.mip_levels},
                      {"/packing/gpu_bytes", &r.gpu_bytes},
                      {"/packing/thin_triangles", &r.thin_triangles},
                      {"/packing/texels_drawn_twice", &*r.texels_drawn_twice},
                      {"/packing/pages/0/width", &page.width},
                      {"/packing/pages/0/height", &page.height},
                      {"/packing/pages/0/charts", &page.charts},
                      {"/packing/pages/0/bytes", &page.image_bytes},
                      {"/grouping/groups", &g.group_count},
                      {"/grouping/capacity", &g.capacity},
                      {"/grouping/largest_group", &g.largest_group},
                      {"/grouping/imbalance", &g.imbalance},
                      {"/grouping/lower_bound", &g.lower_bound},
                      {"/grouping/upper_bound", &g.upper_bound},
                      {"/grouping/group_sizes/0", g.group_size.data()},
                      {"/grouping/trace/0/0", &g.trace[0].capacity},
                      {"/grouping/trace/0/1", &g.trace[0].groups}});
}

TEST(ReportJson, FiguresOfLightAreInTheirPlaces) {
  ExportReport r = complete_report();
  LuminanceStatistics& light = r.luminance;
  Fidelity& f = r.fidelity;
  expect_in_place(r, {{"/textures/texel", &r.texel},
                      {"/textures/packed_texel", &r.packed_texel},
                      {"/textures/final_texels", &r.final_texels},
                      {"/textures/full_texels", &r.full_texels},
                      {"/textures/halved_charts", &r.halved_charts},
                      {"/textures/uniform_charts", &r.uniform_charts},
                      {"/textures/unlit_charts", &r.unlit_charts},
                      {"/textures/capped_charts", &r.capped_charts},
                      {"/textures/raised_charts", &r.raised_charts},
                      {"/textures/sampled_charts", &r.sampled_charts},
                      {"/textures/sampled_texels", &r.sampled_texels},
                      {"/textures/rms_error", &r.downsizing_rms},
                      {"/textures/max_error", &r.downsizing_max},
                      {"/light/white", &r.exposure_white},
                      {"/light/median", &light.median},
                      {"/light/middle", &light.middle},
                      {"/light/percentile98", &light.percentile98},
                      {"/light/percentile99", &light.percentile99},
                      {"/light/seam_length", &r.light_seam_length},
                      {"/light/maximum", &light.maximum},
                      {"/light/mean", &light.mean},
                      {"/light/log_average", &light.log_average},
                      {"/light/lit_area", &light.lit_area},
                      {"/light/unlit_area", &light.unlit_area},
                      {"/light/not_finite", &light.not_finite},
                      {"/light/negative", &light.negative},
                      {"/error/samples_clipped", &f.clipped},
                      {"/error/samples_lit", &f.lit},
                      {"/error/samples_unlit", &f.unlit},
                      {"/error/samples_unplaced", &f.unplaced},
                      {"/error/rmse", &f.rmse},
                      {"/error/psnr", &f.psnr},
                      {"/error/psnr_rgb/0", &f.psnr_channel[0]},
                      {"/error/psnr_rgb/1", &f.psnr_channel[1]},
                      {"/error/psnr_rgb/2", &f.psnr_channel[2]},
                      {"/error/psnr_with_unlit", &f.psnr_all},
                      {"/error/rmse_display", &f.rmse_display},
                      {"/error/p95", &f.p95},
                      {"/error/p999", &f.p999},
                      {"/error/max", &f.maximum}});
  r.full_texels = 8;
  r.final_texels = 2;
  EXPECT_EQ(written(r)["textures"]["saved_share"], 0.75);
}

TEST(ReportJson, WhatWasNotMeasuredIsNotThere) {
  ExportReport r;
  r.carried_out = true;
  json file = written(r);
  for (const char* key : {"light", "textures", "simplify", "error", "grouping"})
    EXPECT_FALSE(file.contains(key)) << key;
  for (const char* key : {"border_texels", "shared_border_texels", "texels_drawn_twice"})
    EXPECT_FALSE(file["packing"].contains(key)) << key;
  EXPECT_TRUE(file.contains("charts"));
  r.carried_out = false;
  file = written(r);
  for (const char* key : {"charts", "packing", "files", "not_kept", "advice"})
    EXPECT_FALSE(file.contains(key)) << key;
}

// Without samples there is no error, and without an error no finite PSNR.
TEST(ReportJson, WhatNoSampleDeterminesIsNull) {
  ExportReport r = complete_report();
  const json none = written(r)["error"];
  for (const char* key : {"rmse", "psnr", "psnr_with_unlit", "rmse_display", "p95", "p999", "max"})
    EXPECT_TRUE(none[key].is_null()) << key;
  r.fidelity.lit = 5;
  r.fidelity.psnr = kPerfectDecibels;
  r.fidelity.psnr_all = 40;
  r.distortion.stretch_linf = std::numeric_limits<double>::infinity();
  const json perfect = written(r);
  EXPECT_TRUE(perfect["error"]["psnr"].is_null());
  EXPECT_EQ(perfect["error"]["psnr_with_unlit"], 40);
  EXPECT_EQ(perfect["error"]["max"], 0);
  EXPECT_TRUE(perfect["charts"]["distortion"]["stretch_linf"].is_null());
}

}  // namespace
}  // namespace atlas
