#include "apps/atlas-export/command_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "apps/common/options.h"
#include "apps/common/program.h"
#include "apps/common/quantity.h"
#include "libatlas/core/counted.h"
#include "libatlas/files/file_extension.h"
#include "libatlas/image/webp.h"

namespace atlas::app {
namespace {

// Options that are read as text and become quantities once all options are known.
struct RawText {
  std::string unit = "m", texel, memory, tone = "linear";
  std::optional<double> lightmap;  // texels per metre
};

void add_scene_options(CLI::App& app, ExportCommand& command, RawText& raw) {
  const OptionGroup group(app, "Scene and world");
  app.add_option("scene", command.scene,
                 "Scene: .obj, .ply, .off, .stl, .gltf, .glb, or a .wrl or .wrz of this program")
      ->required();
  app.add_option("-o,--output", command.options.target,
                 "World to write: .html, .wrl, .wrz, .obj, .gltf or .glb; --plan needs none");
  app.add_option("--unit", raw.unit, "Length of one scene unit: m, cm, mm, in, ft, km or metres")
      ->capture_default_str();
  app.add_option("--illumination", command.read.illumination_file,
                 "Take the vertices' light from this file (same vertices, or one `r g b` a line)");
  app.add_option("--quantity", command.options.quantity,
                 "What the vertices carry: illuminance (reflectance still to apply), luminance, or "
                 "colour (sRGB, as scans have; shown as it is)")
      ->transform(choices<Quantity>({{"illuminance", Quantity::illuminance},
                                     {"luminance", Quantity::luminance},
                                     {"colour", Quantity::colour}}))
      ->type_name("NAME")
      ->default_str("illuminance");
  app.add_option("--up", command.options.up, "The scene's up axis: y or z")
      ->transform(choices<Up>({{"y", Up::y}, {"z", Up::z}}))
      ->type_name("NAME")
      ->default_str("y");
  add_trust_options(app, command.read);
}

void add_chart_options(CLI::App& app, ExportCommand& command) {
  ExportOptions& options = command.options;
  const OptionGroup group(app, "Charts");
  app.add_option("--cone", options.charts.cone_degrees,
                 "Largest angle between a chart's axis and its normals, degrees; 0: no limit but "
                 "--max-stretch")
      ->capture_default_str()
      ->check(within(0, 180));
  app.add_option("--max-stretch", options.charts.max_stretch,
                 "Bound on the stretch over 99.9 % of every chart")
      ->capture_default_str()
      ->check(within(1 + 1e-6, 1e30, "at least 1.000001"));
  app.add_option("--crease", options.charts.crease_degrees,
                 "Bend of an edge, in degrees, from which on a seam along it costs only a quarter; "
                 "at smaller bends, less in proportion")
      ->capture_default_str()
      ->check(within(1e-6, 180, "above 0, at most 180"));
  add_off_flag(app, "--across-materials", options.charts.split_at_materials,
               "Let a chart hold several materials: fewer charts, but light and texture blur "
               "into each other where they meet");
  add_off_flag(app, "--across-light", options.split_at_light,
               "Let a chart continue across creases at which the light jumps: fewer charts, but "
               "the jump blurs over a texel");
  CLI::Option* keep = app.add_flag(
      "--keep-uv-charts", options.charts.keep_uv_charts,
      "Keep the charts of the scene's own texture coordinates and their shapes, whatever "
      "they stretch; flatten anew only those that are flipped, overlapping, squeezed to a line "
      "or missing");
  app.add_option("--uv-aspect", command.uv_aspect,
                 "With --keep-uv-charts: width / height of the page that they were made for; "
                 "without it, what the file says if libatlas wrote it, else 1")
      ->needs(keep)
      ->check(positive());
  app.add_option(
         "--like", command.like,
         "An earlier export of the scene, or any file of it with uvs: charts, uvs and places "
         "of its page stay for all triangles that lie where they lay; only what is new or "
         "changed is unwrapped (uvs without light)")
      ->excludes(keep);
  app.add_option("--seams", command.seams,
                 "Seams to cut in any case: an OBJ file, which may be the scene's own, whose "
                 "polylines (l) follow edges of the scene");
  app.add_option("--min-fill", options.charts.min_fill,
                 "Charts that leave more of a page empty than this are cut to fill it; 0: none is "
                 "cut for the page")
      ->capture_default_str()
      ->check(within(0, 0.999, "at least 0, below 1"));
  app.add_option(
         "--seam-weight", options.charts.seam_weight,
         "What seams count beside stretch: more gives fewer charts and shorter seams, which "
         "stretch more within the bound")
      ->capture_default_str()
      ->check(within(0.001, 1000, "0.001..1000"));
  app.add_option("--preset", options.charts.preset, "Chart quality: fast, default or best")
      ->transform(choices<ChartPreset>({{"fast", ChartPreset::fast},
                                        {"default", ChartPreset::standard},
                                        {"best", ChartPreset::best}}))
      ->type_name("NAME")
      ->default_str("default");
  app.add_flag("--charts-only", options.charts_only,
               "Charts and uvs, no light; on one page, or on as many as --atlases says");
  CLI::Option* scene = app.add_flag(
      "--keep-scene", options.keep_scene,
      "Write the uvs into the scene as it is, and its light, if it has any, as a lightmap: its "
      "objects, materials, textures, normals and own uvs stay (.gltf, .glb; .obj has no room for "
      "textures and own uvs)");
  app.add_option(
         "--uv-set", options.uv_set,
         "With --keep-scene: write the uvs as TEXCOORD_N in place of what it holds, such as "
         "those of an earlier run; default: the first free set")
      ->needs(scene)
      ->check(within(1, 7));
  CLI::Option* instances =
      app.add_option(
             "--instances", options.mesh_uvs,
             "With --keep-scene, of a mesh that is shown several times: uvs that any viewer "
             "reads for each place (default), or extras: the mesh once, with scale and "
             "offset of each place in extras of its node (.gltf, .glb)")
          ->transform(choices<MeshUvs>({{"uvs", MeshUvs::places}, {"extras", MeshUvs::instances}}))
          ->type_name("NAME")
          ->default_str("uvs")
          ->needs(scene);
  app.add_flag_callback(
         "--each", [&options] { options.mesh_uvs = MeshUvs::meshes; },
         "With --keep-scene: uvs for each mesh on a square of its own, once (.gltf, .glb)")
      ->needs(scene)
      ->excludes(instances);
  app.add_flag("--square", options.square_plain_page,
               "Uvs without light on a square page; else its shape is what packs best, and is "
               "printed");
  app.add_flag("--polygons", options.polygons,
               "Write the scene's faces instead of triangles, with no seam inside one (.obj with "
               "uvs alone)");
  app.add_flag("--udim", options.udim,
               "Uvs without light on square UDIM tiles, 1001 to as many as --atlases says, instead "
               "of pages with a material each (.obj)");
}

void add_texture_options(CLI::App& app, ExportOptions& options, RawText& raw) {
  const OptionGroup group(app, "Textures");
  app.add_option("--atlases", options.atlases,
                 "Largest number of atlas pages; of uvs without light and of lightmaps: default 1")
      ->capture_default_str()
      ->check(within(1, 1'000'000));
  app.add_option("--atlas-size", options.atlas_size, "Largest side of a page, a power of two")
      ->capture_default_str()
      ->check(within(64, 16384));
  app.add_option("--memory", raw.memory,
                 "Graphics memory for all pages, e.g. 800MB, without a unit bytes: sets --atlases "
                 "from --atlas-size")
      ->excludes("--atlases");
  app.add_option(
         "--lightmap-options", raw.lightmap,
         "Uvs without light for lightmaps of game engines, with so many texels a metre, 0: as "
         "many as the page holds: a square page, two mip levels, blocks of 4 x 4 texels, "
         "parts of a chart kept apart")
      ->check(not_negative());
  app.add_option(
         "--texel", raw.texel,
         "Length of a texel on the real surface, e.g. 5mm, without a unit metres; default: "
         "what the pages can hold, within 1 to 10 mm, and finer for fine scans; uvs without "
         "light get a page as large as it needs")
      ->excludes("--lightmap-options");
  add_off_flag(app, "--ignore-texture-density", options.follow_textures,
               "Do not refine where the diffuse texture is finer than --texel");
  app.add_option("--threshold", options.threshold,
                 "A texture is halved while no display value changes by more, and by twice as much "
                 "in all; 0: never")
      ->capture_default_str()
      ->check(within(0, 1));
  app.add_option("--min-side", options.min_side, "Halving stops at this side, texels")
      ->capture_default_str()
      ->check(within(1, 256));
  app.add_option("--tone", raw.tone, "Tone curve: linear, reinhard, drago or reinhard-devlin")
      ->capture_default_str();
  app.add_option("--white", options.tone.white,
                 "Scene luminance that becomes display white; 0: measured")
      ->capture_default_str()
      ->check(not_negative());
  app.add_option("--exposure", options.tone.exposure_stops, "Brighter (+) or darker (-), stops")
      ->capture_default_str()
      ->check(within(-64, 64));
}

int parse_quality(const std::string& text) {
  if (text == "lossless") return 0;
  int quality = 0;
  const char* end = text.data() + text.size();
  const auto [read, error] = std::from_chars(text.data(), end, quality);
  if (error != std::errc() || read != end || quality < 1 || quality > 100)
    throw CLI::ValidationError("--quality", text + ": give 1..100, or lossless");
  return quality;
}

void add_page_options(CLI::App& app, ExportOptions& options) {
  const OptionGroup group(app, "Pages and mesh");
  app.add_option("--shifts", options.shifts, "Sub-texel sample grids of the bake")
      ->capture_default_str()
      ->check(within(1, 64));
  app.add_option("--mips", options.mip_levels,
                 "Mip levels whose lookups must not see a neighbouring chart; unless given, more "
                 "where pages have room, and 0 for uvs without light")
      ->capture_default_str()
      ->check(within(0, kMostMipLevels));
  app.add_option("--bake", options.bake_method, "least-squares, or average (as published)")
      ->transform(choices<BakeMethod>(
          {{"least-squares", BakeMethod::least_squares}, {"average", BakeMethod::average}}))
      ->type_name("NAME")
      ->default_str("least-squares");
  app.add_option("--packing", options.packing, "Packing effort: fast, default or best")
      ->transform(choices<PackPreset>({{"fast", PackPreset::fast},
                                       {"default", PackPreset::standard},
                                       {"best", PackPreset::best}}))
      ->type_name("NAME")
      ->default_str("default");
  add_budget(app, "--packing", options.time_budget);
  add_off_flag(app, "--boxes", options.outlines,
               "Pack the charts' boxes only; else outlines too, and the better of both is kept");
  add_off_flag(app, "--no-simplify", options.simplify,
               "Write the scene's own triangles, not the coarser mesh");
  app.add_option("--slip", options.simplify_slip,
                 "How far the coarser mesh and its texture may slip, texels")
      ->capture_default_str()
      ->check(positive());
  app.add_flag("--exr", options.exr, "Also write scene-linear OpenEXR pages")
      ->excludes("--charts-only");
  app.add_flag("--linear", options.linear,
               "Pages of an .html hold the light itself: exposure, tone curve and false colours in "
               "the browser")
      ->excludes("--charts-only");
  CLI::Option* format =
      app.add_option("--texture-format", options.texture_format,
                     "Format of the pages' images: png, or webp, which is smaller (.gltf, .glb, "
                     ".html); unless given, .html has webp of quality 95")
          ->transform(
              choices<TextureFormat>({{"png", TextureFormat::png}, {"webp", TextureFormat::webp}}))
          ->type_name("NAME")
          ->default_str("png");
  app.add_option_function<std::string>(
         "--quality",
         [&options](const std::string& text) { options.webp_quality = parse_quality(text); },
         "Of WebP images: 1 (smallest) to 100, or lossless")
      ->type_name("N|lossless")
      ->default_str("lossless")
      ->needs(format);
  app.add_flag(
      "--compress", options.compress,
      "Pack the mesh (EXT_meshopt_compression); positions and uvs of worlds become 16 bits "
      "where a quarter of --slip allows it (.gltf, .glb)");
  app.add_option("--png-level", options.png_compression, "PNG compression, 0..9; 1 to 5 are one")
      ->capture_default_str()
      ->check(within(0, 9));
}

void add_run_options(CLI::App& app, ExportCommand& command) {
  const OptionGroup group(app, "Running");
  app.add_option("--report", command.reports,
                 "Write a report of every stage, or with --plan of the plan: a page to read if it "
                 "ends in .html, else JSON; may be given several times")
      ->allow_extra_args(false);
  app.add_flag("--report-charts", command.request.chart_rows,
               "The JSON report has a row of figures for each chart")
      ->needs("--report");
  app.add_option("--false-colour", command.options.false_colour,
                 "Also draw the light in false colours, from above and on the pages (.png)")
      ->excludes("--charts-only");
  app.add_option("--depfile", command.depfile,
                 "Also write a rule for make and ninja that lists every file that was read");
  app.add_flag("--durable", command.options.durable,
               "End only when the disk holds the world, so that it outlasts a power failure");
  app.add_flag("--plan", command.plan_only, "Print what would run and why, and stop");
  add_off_flag(app, "--no-error", command.options.measure_error, "Do not measure the pages' error");
  app.add_flag("-q,--quiet", command.quiet, "Print warnings and errors only");
  app.add_option("--threads", command.threads, "Threads; 0: all cores")
      ->check(within(0, 1024))
      ->capture_default_str();
}

// Returns a word as a shell takes it.
std::string quoted(const std::string& word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=:,+%@";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

constexpr int kHtmlQuality = 95;                // of WebP
constexpr double kMostPages = 1e6;              // the limit of --atlases
constexpr double kBytesPerTexel = 4.0 * 4 / 3;  // RGBA8 and its mip chain

// Converts the texts into numbers. Returns a message about the first text that is wrong.
std::optional<std::string> interpret(const RawText& raw, ExportCommand& command) {
  ExportOptions& options = command.options;
  const auto unit = parse_unit(raw.unit);
  if (!unit)
    return fmt::format("--unit {}: give m, cm, mm, in, ft, km or metres (1e-12 to 1e24)", raw.unit);
  command.read.metres_per_unit = *unit;
  if (!raw.texel.empty()) {
    const auto texel = parse_length(raw.texel);
    if (!texel)
      return fmt::format(
          "--texel {}: give a length above 0 such as 5mm, in m, cm, mm, in, ft or km", raw.texel);
    options.texel_metres = *texel;
  }
  const auto tone = parse_tone_operator(raw.tone);
  if (!tone.ok()) return "--tone: " + tone.status().message();
  options.tone.op = *tone;
  if (!raw.memory.empty()) {
    const auto bytes = parse_bytes(raw.memory);
    if (!bytes)
      return fmt::format(
          "--memory {}: give a size such as 800MB, in kB, MB, GB, KiB, MiB or GiB (without a unit: "
          "bytes)",
          raw.memory);
    const auto page = [&] {
      return kBytesPerTexel * double(options.atlas_size) * double(options.atlas_size);
    };
    while (options.atlas_size > 64 && page() > double(*bytes)) options.atlas_size /= 2;
    if (page() > double(*bytes))
      return fmt::format(
          "--memory {}: {}, less than the {:.0f} of a single page of 64 x 64 texels (give a "
          "size such as 800MB)",
          raw.memory, counted(*bytes, "byte"), page());
    options.atlases = std::uint32_t(std::clamp(double(*bytes) / page(), 1.0, kMostPages));
  }
  return std::nullopt;
}

}  // namespace

bool is_page(const std::filesystem::path& report) {
  return lower_extension(report) == ".html";
}

constexpr std::pair<const char*, const char*> kExamples[] = {
    {"A page that any browser opens, and a report to read",
     "scene.ply -o world.html --report report.html"},
    {"Uvs without light, on a square page", "part.obj -o part_uv.obj --charts-only --square"},
    {"A lightmap of 1 cm a texel for a scene that stays as it is",
     "room.glb -o room_lit.glb --keep-scene --texel 1cm"}};

std::optional<ExportCommand> parse_export_command(int argc, char** argv, int& exit_code) {
  CLI::App app(
      "Turns a scene whose vertices carry illumination into a walkable world with texture atlases.",
      "atlas-export");
  ExportCommand command;
  RawText raw;
  add_scene_options(app, command, raw);
  add_chart_options(app, command);
  add_texture_options(app, command.options, raw);
  add_page_options(app, command.options);
  add_run_options(app, command);
  add_examples(app, kExamples);
  exit_code = parse(app, argc, argv);
  if (exit_code >= 0) return std::nullopt;
  exit_code = 2;
  if (const auto wrong = interpret(raw, command)) {
    print_error("atlas-export", *wrong);
    return std::nullopt;
  }
  if (command.options.target.empty() && !command.plan_only) {
    print_error("atlas-export", "--output is required (--help lists the options)");
    return std::nullopt;
  }
  if (command.plan_only && command.quiet && command.reports.empty()) {
    print_error("atlas-export",
                "--plan with --quiet tells nothing (leave one out, or add --report)");
    return std::nullopt;
  }
  for (int i = 0; i < argc; ++i) command.request.command += (i > 0 ? " " : "") + quoted(argv[i]);
  command.request.options = option_values(app, argc, argv);
  command.options.report_pictures =
      !command.plan_only && std::any_of(command.reports.begin(), command.reports.end(), is_page);
  // An OBJ that keeps the scene has the colours of its vertices as the scene's file has them,
  // unless they become a lightmap.
  const bool as_written = command.options.keep_scene && command.options.charts_only &&
                          lower_extension(command.options.target) == ".obj";
  command.read.srgb_colours = command.options.quantity == Quantity::colour && !as_written;
  command.options.colours_are_light = app.count("--quantity") > 0;
  command.options.larger_plain_page = app.count("--atlas-size") == 0;
  if (raw.lightmap) use_lightmap_options(*raw.lightmap, command.options);
  // Pages of HTML are to be small.
  if (lower_extension(command.options.target) == ".html" && app.count("--texture-format") == 0 &&
      command.options.atlas_size <= kLongestWebpSide) {
    command.options.texture_format = TextureFormat::webp;
    command.options.webp_quality = kHtmlQuality;
  }
  const bool asked = app.count("--atlases") > 0;
  if (asked) command.options.plain_pages = command.options.atlases;
  if (asked || app.count("--memory") > 0) command.options.lightmap_pages = command.options.atlases;
  if (app.count("--mips") > 0) {
    command.options.plain_mip_levels = command.options.mip_levels;
    command.options.more_mip_levels = false;
  }
  return command;
}

}  // namespace atlas::app
