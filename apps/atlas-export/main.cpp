// atlas-export: a lit scene in, a walkable world with texture atlases out.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "apps/atlas-export/command_line.h"
#include "apps/atlas-export/flag_names.h"
#include "apps/common/depfile.h"
#include "apps/common/files.h"
#include "apps/common/options.h"
#include "apps/common/program.h"
#include "apps/common/terminal.h"
#include "libatlas/core/clock.h"
#include "libatlas/core/counted.h"
#include "libatlas/exporters/world.h"
#include "libatlas/files/file_extension.h"
#include "libatlas/pipeline/export_world.h"
#include "libatlas/pipeline/lightmap.h"
#include "libatlas/pipeline/plan.h"
#include "libatlas/report/html_report.h"
#include "libatlas/scene/seam_lines.h"

namespace {

using namespace atlas;

void print_plan(const ExportPlan& plan, app::Terminal& terminal) {
  for (const PlanStep& step : plan.steps) {
    terminal.line(fmt::format("{} {:<12} {}", step.run ? "run " : "skip", step.stage, step.reason));
  }
}

void print_result(const ExportReport& report, const ExportOptions& options,
                  app::Terminal& terminal) {
  if (!report.lit) {
    terminal.line(fmt::format("The scene carries no illumination: the result has plain uvs and {}.",
                              options.keep_scene ? "no light" : "no images"));
  }
  const std::size_t pages = report.pages.size();
  std::vector<Extent> plain;
  for (const PageReport& page : report.pages)
    if (report.gpu_bytes == 0) plain.push_back({page.width, page.height});
  const std::string texels =
      options.texel_metres > 0 ? fmt::format(", texels of {:g} m", options.texel_metres) : "";
  terminal.line(fmt::format("{}: {} on {}, {}", report.target.string(),
                            counted(report.triangles_out, "triangle"), counted(pages, "page"),
                            plain.empty()
                                ? fmt::format("{:.1f} MiB of graphics memory",
                                              double(report.gpu_bytes) / (1024.0 * 1024.0))
                                : plain_pages_text(plain, options.udim) + texels));
  if (has_lightmap(report.lit, options)) terminal.line(lightmap_text(lightmap_of(report, options)));
}

// Names what a scene without light has at its vertices, which may be light under another name.
void name_unread_values(const Scene& scene, app::Terminal& terminal) {
  constexpr std::string_view kKind = "values of vertices: ";
  std::string names;
  for (const auto& [kind, count] : scene.not_read)
    if (kind.starts_with(kKind) && kind != "values of vertices: alpha")
      names += (names.empty() ? "" : ", ") + kind.substr(kKind.size());
  if (scene.lit() || names.empty()) return;
  terminal.line(fmt::format(
      "not read as light: {} of the vertices (light is called illuminance, or illuminance_r, "
      "illuminance_g and illuminance_b; or --illumination names a file of it)",
      names));
}

// Names the pages that an earlier export to the same name, with more pages or as EXR, has left:
// they are not part of this world.
void name_old_pages(const ExportReport& report, const ExportOptions& options,
                    app::Terminal& terminal) {
  const std::filesystem::path folder = report.target.parent_path();
  if (report.gpu_bytes == 0) return;  // pages without images
  const auto name = [&](std::size_t written, const char* ending, const char* run) {
    const auto page = [&](std::size_t p) {
      return folder / (page_name(report.target, p) + ending);
    };
    const std::vector<std::filesystem::path> old = app::files_there(written, page);
    if (!old.empty()) terminal.line(app::old_pages_text(old, run, "this world"));
  };
  if (!embeds_images(report.target) || options.keep_scene)
    name(report.pages.size(), page_extension(options.texture_format), "export with more pages");
  const bool exr = options.exr;
  name(exr ? report.pages.size() : 0, ".exr", exr ? "export with more pages" : "export with --exr");
}

StageReport reading_stage(const LoadedScene& loaded, double cpu, double wall) {
  StageReport stage;
  stage.stage = "reading";
  stage.cpu_seconds = cpu_seconds() - cpu;
  stage.wall_seconds = wall_seconds() - wall;
  stage.peak_memory = peak_memory();
  stage.size_in = loaded.scene.positions.size();
  stage.size_out = loaded.scene.triangle_count();
  stage.unit = "triangles";
  return stage;
}

// Returns whether a file has the name of a page's image, or of a kept texture's if `kind` is
// "texture".
bool named_as_page(const std::filesystem::path& file, const std::filesystem::path& target,
                   const char* kind = "") {
  const std::string pages = safe_file_name(target.stem().string()) + "_" + kind;
  const std::string name = file.stem().string();
  return name.size() > pages.size() && name.starts_with(pages) &&
         name.find_first_not_of("0123456789", pages.size()) == std::string::npos;
}

// Returns the existing files that have names of images that this export may write: pages of an
// earlier export, or links to any file.
std::vector<std::filesystem::path> images_there(const Scene& scene, const ExportOptions& options) {
  const std::filesystem::path& target = options.target;
  if (target.empty()) return {};
  const auto folder = target.has_parent_path() ? target.parent_path() : std::filesystem::path(".");
  std::vector<std::filesystem::path> there;
  std::error_code error;
  if (options.keep_scene && lower_extension(target) == ".gltf") {
    for (std::filesystem::path& image : scene_texture_paths(scene, target))
      if (std::filesystem::exists(image, error)) there.push_back(std::move(image));
  }
  if (scene.lit() && !options.charts_only) {
    std::filesystem::directory_iterator at(folder, error);
    for (; !error && at != std::filesystem::directory_iterator(); at.increment(error)) {
      const std::filesystem::path ending = at->path().extension();
      const bool page = (ending == page_extension(options.texture_format) &&
                         (!embeds_images(target) || options.keep_scene)) ||
                        (ending == ".exr" && options.exr);
      if (page && named_as_page(at->path(), target)) there.push_back(at->path());
    }
  }
  return there;
}

Status check_no_image(const char* flag, const std::filesystem::path& output,
                      const std::filesystem::path& target) {
  const std::string ending = lower_extension(output);
  const bool image = ending == ".png" || ending == ".webp" || ending == ".exr" || ending == ".jpg";
  if (image && !target.empty() &&
      (named_as_page(output, target) || named_as_page(output, target, "texture")))
    return {ErrorCode::bad_option,
            fmt::format("{} {}: is the name of an image of the world (give it another)", flag,
                        output.string())};
  return {};
}

// Returns the files that are written beside the world, with their options.
std::vector<std::pair<const char*, std::filesystem::path>> outputs_beside(
    const app::ExportCommand& command) {
  std::vector<std::pair<const char*, std::filesystem::path>> outputs;
  for (const std::filesystem::path& report : command.reports)
    outputs.emplace_back("--report", report);
  outputs.emplace_back("--depfile", command.depfile);
  outputs.emplace_back("--false-colour", command.options.false_colour);
  return outputs;
}

Status check_outputs(const app::ExportCommand& command) {
  const std::filesystem::path& target = command.options.target;
  std::vector<std::filesystem::path> others{command.scene, command.read.illumination_file,
                                            command.seams};
  if (Status s = app::check_output(file_beside(target), others); !s.ok()) return s;
  others.insert(others.end(), command.reports.begin(), command.reports.end());
  if (Status s = app::check_output(target, others); !s.ok()) return s;
  others.resize(3);
  others.push_back(command.like);  // the world may take its place
  others.push_back(target);
  others.push_back(file_beside(target));
  for (const auto& [flag, output] : outputs_beside(command)) {
    if (Status s = app::check_output(output, others); !s.ok()) return s;
    if (Status s = check_no_image(flag, output, target); !s.ok()) return s;
    others.push_back(output);
  }
  return {};
}

// Refuses outputs that would overwrite files of the scene: its material files, buffers and textures
// are known only when it has been read. A world that is exported again has textures with the names
// of the new pages.
Status check_files_stay(const LoadedScene& loaded, const app::ExportCommand& command) {
  const std::filesystem::path& target = command.options.target;
  std::vector<std::filesystem::path> known = loaded.files;
  known.insert(known.end(), loaded.unread_files.begin(), loaded.unread_files.end());
  for (const Texture& texture : loaded.scene.textures) known.push_back(texture.path);
  const auto beside = outputs_beside(command);
  for (const std::filesystem::path& file : known) {
    for (const std::filesystem::path& output : {target, file_beside(target)})
      if (Status s = app::check_output(output, {file}); !s.ok()) return s;
    for (const auto& [flag, output] : beside)
      if (Status s = app::check_output(output, {file}); !s.ok()) return s;
  }
  if (command.options.keep_scene && lower_extension(target) == ".gltf")
    for (const std::filesystem::path& image : scene_texture_paths(loaded.scene, target))
      for (const auto& [flag, output] : beside)
        if (Status s = app::check_output(output, {image}); !s.ok()) return s;
  known.insert(known.end(), {command.scene, command.read.illumination_file});
  for (const auto& [flag, output] : beside) known.push_back(output);
  const ExportOptions planned = planned_options(loaded.scene, command.options);
  for (const std::filesystem::path& image : images_there(loaded.scene, planned))
    for (const std::filesystem::path& file : known) {
      std::error_code error;
      if (std::filesystem::equivalent(image, file, error))
        return {ErrorCode::bad_option,
                fmt::format("{}: its images would overwrite {}, which is read or written as well "
                            "(give the output another name)",
                            target.string(), file.string())};
    }
  return {};
}

// Light that includes the reflectance needs no texel.
bool uses_textures(const app::ExportCommand& command) {
  return command.options.keep_scene || command.options.quantity == Quantity::illuminance;
}

bool is_texture(const std::filesystem::path& file, const Scene& scene) {
  return std::any_of(scene.textures.begin(), scene.textures.end(),
                     [&](const Texture& texture) { return texture.path == file; });
}

// Adds the dependency file, if asked for, to what is written with the world.
Status add_depfile(const app::ExportCommand& command, const LoadedScene& loaded,
                   ExportOptions& options) {
  if (command.depfile.empty()) return {};
  std::vector<std::filesystem::path> inputs{command.scene, command.read.illumination_file,
                                            command.like, command.seams};
  std::copy_if(loaded.files.begin(), loaded.files.end(), std::back_inserter(inputs),
               [&](const std::filesystem::path& file) {
                 return uses_textures(command) || !is_texture(file, loaded.scene);
               });
  Result<std::string> rule = app::dependency_rule(options.target, inputs);
  if (!rule.ok()) return rule.status();
  options.extra_files.push_back({command.depfile, std::move(*rule)});
  return {};
}

// Writes the reports that were asked for, with the export's own figures and those of reading, which
// came before it.
Status write_report(ExportReport report, const StageReport& reading,
                    const app::ExportCommand& command, app::Terminal& terminal) {
  if (command.reports.empty()) return {};
  report.scene = command.scene;
  for (std::string& line : report.advice) line = app::with_flag_names(line);
  report.stages.insert(report.stages.begin(), reading);
  report.cpu_seconds += reading.cpu_seconds;
  report.wall_seconds += reading.wall_seconds;
  report.peak_memory = std::max(report.peak_memory, reading.peak_memory);
  for (const std::filesystem::path& path : command.reports) {
    const Status written = app::is_page(path) ? write_html(report, command.request, path)
                                              : write_json(report, path, command.request);
    if (!written.ok()) return written;
    terminal.line(fmt::format("{}: report", path.string()));
  }
  return {};
}

// Prints what would run, and writes the report if asked for. Errors that would end the export
// before its first stage are returned here, too.
Status plan(const app::ExportCommand& command, const LoadedScene& loaded,
            const StageReport& reading, app::Terminal& terminal) {
  const ExportPlan plan = make_plan(loaded.scene, command.options);
  print_plan(plan, terminal);
  if (Status s = check_plan(plan, command.options); !s.ok()) return s;
  return write_report(planned_report(loaded, plan, command.options), reading, command, terminal);
}

bool is_gltf(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  return extension == ".gltf" || extension == ".glb";
}

// Returns options for reading only what this export uses of the scene.
ReadOptions read_options(const app::ExportCommand& command) {
  ReadOptions read = command.read;
  read.load_textures = !command.options.charts_only;
  // What texture files there are must be known in any case, since pages must not replace them.
  read.encoded_textures = !uses_textures(command);
  read.unlit_textures = false;  // without light no page has an image
  read.polygons = command.options.polygons;
  if (!command.options.keep_scene) return read;
  // A glTF file that is written again keeps its normals by itself.
  read.normals = !(is_gltf(command.scene) && is_gltf(command.options.target));
  read.encoded_textures = read.rest = true;
  read.load_textures = read.unlit_textures = lower_extension(command.options.target) != ".obj";
  return read;
}

// Reads the seams, if they are given.
Status read_seams(const app::ExportCommand& command, const Scene& scene, ExportOptions& options,
                  const Context& context) {
  if (command.seams.empty()) return {};
  Result<SeamLines> seams = read_seam_lines(command.seams, scene);
  if (!seams.ok()) return seams.status();
  if (seams->found < seams->segments)
    context.say(fmt::format("{}: {} of {} segments are no edges of the scene, and left out",
                            command.seams.string(), seams->segments - seams->found,
                            seams->segments));
  options.seams = std::move(seams->edges);
  return {};
}

// Reads the earlier export, if one is given.
Result<LoadedScene> read_like(const app::ExportCommand& command, const Context& context) {
  if (command.like.empty()) return LoadedScene{};
  ReadOptions read;
  read.metres_per_unit = command.read.metres_per_unit;
  read.confine = command.read.confine;
  read.limits = command.read.limits;
  read.load_textures = read.unlit_textures = false;
  read.told_uvs = true;
  return read_scene(command.like, read, context);
}

// A plan needs no target. The options are then those for a target that takes all of them.
Status check_command(const app::ExportCommand& command) {
  ExportOptions options = command.options;
  if (options.target.empty()) options.target = "plan.glb";
  return check_options(options);
}

Status run(const app::ExportCommand& command, app::Terminal& terminal) {
  if (Status s = check_command(command); !s.ok()) return s;
  if (Status s = check_outputs(command); !s.ok()) return s;
  const Context context = terminal.context(command.threads);
  const double cpu = cpu_seconds(), wall = wall_seconds();
  const ReadOptions read = read_options(command);
  Result<LoadedScene> loaded = read_scene(command.scene, read, context);
  if (!loaded.ok()) return loaded.status();
  if (Status s = check_files_stay(*loaded, command); !s.ok()) return s;
  for (const std::string& line : loaded->defects.lines()) terminal.line("defect: " + line);
  const StageReport reading = reading_stage(*loaded, cpu, wall);
  if (command.plan_only) {
    if (const std::string line = colours_text(loaded->scene, command.options); !line.empty())
      context.say(line);
    return plan(command, *loaded, reading, terminal);
  }
  terminal.line(stage_line(reading));
  ExportOptions options = command.options;
  options.charts.uv_aspect =
      command.uv_aspect.value_or(loaded->uv_aspect > 0 ? loaded->uv_aspect : 1);
  if (!command.uv_aspect) options.charts.material_uv_aspects = loaded->material_uv_aspects;
  if (Status s = read_seams(command, loaded->scene, options, context); !s.ok()) return s;
  const Result<LoadedScene> like = read_like(command, context);
  if (!like.ok()) return like.status();
  if (!command.like.empty()) options.like = &*like;
  if (Status s = add_depfile(command, *loaded, options); !s.ok()) return s;
  Result<ExportReport> report = export_world(
      *loaded, options, [&](const StageReport& stage) { terminal.line(stage_line(stage)); },
      context);
  if (!report.ok()) return report.status();
  print_result(*report, planned_options(loaded->scene, command.options), terminal);
  if (!command.options.charts_only && !command.options.keep_scene)
    name_unread_values(loaded->scene, terminal);
  for (const std::string& line : report->not_kept) terminal.line("not kept: " + line);
  name_old_pages(*report, command.options, terminal);
  return write_report(std::move(*report), reading, command, terminal);
}

int main_of(int argc, char** argv) {
  int code = 0;
  const auto command = app::parse_export_command(argc, argv, code);
  if (!command) return code;
  app::name_input(command->scene);
  app::Terminal terminal("atlas-export", command->quiet);
  terminal.reword(app::with_flag_names);
  const Status status = run(*command, terminal);
  if (!status.ok()) terminal.error(status.message());
  return app::exit_code(status);
}

}  // namespace

int main(int argc, char** argv) {
  return atlas::app::run_program("atlas-export", argc, argv, main_of);
}
