// The command line of atlas-export: every option fills in what it is named after, and messages name
// the options.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/atlas-export/command_line.h"
#include "apps/atlas-export/flag_names.h"

namespace atlas::test {
namespace {

using app::ExportCommand;

ExportCommand parsed(std::vector<const char*> words) {
  words.insert(words.begin(), {"atlas-export", "in.obj", "-o", "out.wrl"});
  int exit_code = 0;
  std::optional<ExportCommand> command =
      app::parse_export_command(int(words.size()), const_cast<char**>(words.data()), exit_code);
  EXPECT_TRUE(command) << words.back();
  return command.value_or(ExportCommand{});
}

TEST(ExportOptions, NamesOfChoicesMeanThemselves) {
  const std::map<const char*, ChartPreset> charts{
      {"fast", ChartPreset::fast}, {"default", ChartPreset::standard}, {"best", ChartPreset::best}};
  const std::map<const char*, PackPreset> packings{
      {"fast", PackPreset::fast}, {"default", PackPreset::standard}, {"best", PackPreset::best}};
  for (const auto& [name, preset] : charts)
    EXPECT_EQ(parsed({"--preset", name}).options.charts.preset, preset) << name;
  for (const auto& [name, preset] : packings)
    EXPECT_EQ(parsed({"--packing", name}).options.packing, preset) << name;
  EXPECT_EQ(parsed({}).options.charts.preset, ChartPreset::standard);
  EXPECT_EQ(parsed({}).options.packing, PackPreset::standard);
  EXPECT_EQ(parsed({"--bake", "average"}).options.bake_method, BakeMethod::average);
  EXPECT_EQ(parsed({"--bake", "least-squares"}).options.bake_method, BakeMethod::least_squares);
  EXPECT_EQ(parsed({"--up", "z"}).options.up, Up::z);
  EXPECT_EQ(parsed({"--up", "y"}).options.up, Up::y);
  EXPECT_EQ(parsed({"--quantity", "luminance"}).options.quantity, Quantity::luminance);
  EXPECT_EQ(parsed({"--quantity", "illuminance"}).options.quantity, Quantity::illuminance);
  EXPECT_EQ(parsed({"--quantity", "colour"}).options.quantity, Quantity::colour);
  EXPECT_TRUE(parsed({"--quantity", "colour"}).read.srgb_colours);
  EXPECT_FALSE(parsed({"--quantity", "luminance"}).read.srgb_colours);
}

TEST(ExportOptions, OfCharts) {
  const ChartOptions c = parsed({"--cone", "60", "--max-stretch", "1.5", "--crease", "25",
                                 "--across-materials", "--keep-uv-charts"})
                             .options.charts;
  EXPECT_EQ(c.cone_degrees, 60);
  EXPECT_EQ(c.max_stretch, 1.5);
  EXPECT_EQ(c.crease_degrees, 25);
  EXPECT_FALSE(c.split_at_materials);
  EXPECT_TRUE(c.keep_uv_charts);
  const ExportCommand plain = parsed({});
  EXPECT_TRUE(plain.options.charts.split_at_materials);
  EXPECT_FALSE(plain.options.charts.keep_uv_charts);
  EXPECT_EQ(plain.uv_aspect, std::nullopt);
  EXPECT_EQ(parsed({"--keep-uv-charts", "--uv-aspect", "4"}).uv_aspect, 4);
  EXPECT_EQ(parsed({"--min-fill", "0"}).options.charts.min_fill, 0);
  EXPECT_EQ(parsed({"--seam-weight", "2"}).options.charts.seam_weight, 2);
  EXPECT_EQ(parsed({"--like", "old.obj"}).like, "old.obj");
  EXPECT_EQ(parsed({"--seams", "cut.obj"}).seams, "cut.obj");
  EXPECT_TRUE(parsed({"--square"}).options.square_plain_page);
  EXPECT_TRUE(parsed({"--charts-only"}).options.charts_only);
  EXPECT_TRUE(parsed({"--keep-scene"}).options.keep_scene);
}

TEST(ExportOptions, OfPolygonsInstancesAndLightmaps) {
  EXPECT_TRUE(parsed({"--polygons"}).options.polygons);
  EXPECT_EQ(parsed({"--keep-scene"}).options.mesh_uvs, MeshUvs::places);
  EXPECT_EQ(parsed({"--keep-scene", "--instances", "uvs"}).options.mesh_uvs, MeshUvs::places);
  EXPECT_EQ(parsed({"--keep-scene", "--instances", "extras"}).options.mesh_uvs, MeshUvs::instances);
  EXPECT_EQ(parsed({"--keep-scene", "--each"}).options.mesh_uvs, MeshUvs::meshes);
  for (const double texels : {0.0, 20.0}) {
    ExportOptions expected;
    use_lightmap_options(texels, expected);
    const ExportOptions o = parsed({"--lightmap-options", texels > 0 ? "20" : "0"}).options;
    EXPECT_EQ(o.square_plain_page, expected.square_plain_page);
    EXPECT_EQ(o.plain_mip_levels, expected.plain_mip_levels);
    EXPECT_EQ(o.plain_padding, expected.plain_padding);
    EXPECT_EQ(o.plain_part_gaps, expected.plain_part_gaps);
    EXPECT_EQ(o.larger_plain_page, expected.larger_plain_page);
    EXPECT_EQ(o.texel_metres, expected.texel_metres);
    EXPECT_EQ(o.plain_pages, 1u);
  }
}

// Plain pages are as many as asked for, and grow unless their side is given.
TEST(ExportOptions, OfPages) {
  const ExportOptions none = parsed({}).options;
  EXPECT_EQ(none.plain_pages, 1u);
  EXPECT_TRUE(none.larger_plain_page);
  const ExportOptions both = parsed({"--atlases", "5", "--atlas-size", "512"}).options;
  EXPECT_EQ(both.atlases, 5u);
  EXPECT_EQ(both.plain_pages, 5u);
  EXPECT_EQ(both.atlas_size, 512);
  EXPECT_FALSE(both.larger_plain_page);
  EXPECT_EQ(parsed({"--memory", "100MB"}).options.plain_pages, 1u);
}

// A page of 64 x 64 texels takes 21845.3 bytes.
TEST(ExportOptions, MemoryIsForWholePagesUpToAMillion) {
  const auto pages = [](const char* memory, const char* side) {
    const ExportOptions o = parsed({"--atlas-size", side, "--memory", memory}).options;
    return std::pair(int(o.atlases), o.atlas_size);
  };
  EXPECT_EQ(pages("21846", "64"), std::pair(1, 64));
  EXPECT_EQ(pages("43690", "64"), std::pair(1, 64));
  EXPECT_EQ(pages("43691", "64"), std::pair(2, 64));
  EXPECT_EQ(pages("9000TB", "64"), std::pair(1'000'000, 64));
  EXPECT_EQ(pages("87382", "256"), std::pair(1, 128));
}

TEST(ExportOptions, OfTexturesAndTheMesh) {
  const ExportOptions o =
      parsed({"--threshold", "0.5", "--min-side", "32", "--white", "7", "--exposure", "-2",
              "--ignore-texture-density", "--texel", "2mm", "--tone", "drago"})
          .options;
  EXPECT_EQ(o.threshold, 0.5);
  EXPECT_EQ(o.min_side, 32);
  EXPECT_EQ(o.tone.white, 7);
  EXPECT_EQ(o.tone.exposure_stops, -2);
  EXPECT_EQ(o.tone.op, ToneOperator::drago);
  EXPECT_FALSE(o.follow_textures);
  EXPECT_DOUBLE_EQ(o.texel_metres, 0.002);
  const ExportOptions p = parsed({"--shifts", "9", "--mips", "1", "--boxes", "--no-simplify",
                                  "--slip", "0.5", "--exr", "--png-level", "8", "--no-error"})
                              .options;
  EXPECT_EQ(p.shifts, 9);
  EXPECT_EQ(p.mip_levels, 1);
  EXPECT_FALSE(p.more_mip_levels || p.outlines || p.simplify || p.measure_error);
  EXPECT_EQ(p.simplify_slip, 0.5);
  EXPECT_TRUE(p.exr);
  EXPECT_EQ(p.png_compression, 8);
  EXPECT_DOUBLE_EQ(parsed({"--packing", "best", "--budget", "500ms"}).options.time_budget, 0.5);
  const ExportOptions plain = parsed({}).options;
  EXPECT_TRUE(plain.more_mip_levels && plain.follow_textures && plain.outlines && plain.simplify &&
              plain.measure_error);
  EXPECT_TRUE(std::isinf(plain.time_budget));
  EXPECT_FALSE(plain.exr || plain.square_plain_page || plain.charts_only || plain.keep_scene);
}

TEST(ExportOptions, OfFilesAndRunning) {
  const ExportCommand c =
      parsed({"--illumination", "light.txt", "--report", "r.json", "--plan", "-q", "--threads", "3",
              "--unit", "cm", "--report-charts", "--durable"});
  EXPECT_EQ(c.scene, "in.obj");
  EXPECT_EQ(c.options.target, "out.wrl");
  EXPECT_EQ(c.read.illumination_file, "light.txt");
  EXPECT_EQ(c.reports, std::vector<std::filesystem::path>{"r.json"});
  EXPECT_TRUE(c.plan_only && c.quiet && c.request.chart_rows && c.options.durable);
  EXPECT_EQ(c.threads, 3);
  EXPECT_EQ(c.read.metres_per_unit, 0.01);
  const ExportCommand plain = parsed({});
  EXPECT_FALSE(plain.plan_only || plain.quiet || plain.request.chart_rows || plain.options.durable);
  EXPECT_EQ(parsed({}).threads, 0);
}

TEST(FlagNames, ReplaceTheNamesOfFieldsEverywhere) {
  EXPECT_EQ(app::with_flag_names("ExportOptions::atlases"), "--atlases");
  EXPECT_EQ(app::with_flag_names("more ExportOptions::atlases, a larger ExportOptions::atlas_size "
                                 "(ExportOptions::atlases)"),
            "more --atlases, a larger --atlas-size (--atlases)");
  EXPECT_EQ(app::with_flag_names("nothing of that kind"), "nothing of that kind");
  EXPECT_EQ(app::with_flag_names("ToneOptions::white must be"), "--white must be");
}

// A field whose name goes on is another field.
TEST(FlagNames, LeaveLongerNames) {
  for (const char* rest : {"_x", "x", "z", "a", "0", "9"}) {
    const std::string longer = fmt::format("ExportOptions::shifts{}", rest);
    EXPECT_EQ(app::with_flag_names(longer), longer);
    EXPECT_EQ(app::with_flag_names(longer + " ExportOptions::shifts"), longer + " --shifts");
  }
  EXPECT_EQ(app::with_flag_names("ExportOptions::shifts."), "--shifts.");
  EXPECT_EQ(app::with_flag_names("ExportOptions::shiftsA"), "--shiftsA");
}

}  // namespace
}  // namespace atlas::test
