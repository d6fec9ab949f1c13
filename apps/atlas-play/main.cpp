// atlas-play: shows a scene under a moving light. Parses the command line, calls libatlas/view, and
// prints.
#include <fmt/format.h>

#include <memory>
#include <utility>
#include <vector>

#include "apps/atlas-play/command_line.h"
#include "apps/common/files.h"
#include "apps/common/options.h"
#include "apps/common/program.h"
#include "apps/common/terminal.h"
#include "libatlas/files/file_extension.h"

namespace atlas::app {
namespace {

Result<BenchResult> measure(const CommandLine& line, const GlContext& gl, const Renderer& renderer,
                            const Context& context) {
  BenchOptions options = line.measure;
  options.render = line.render;
  options.camera = line.play.camera;
  options.degrees_per_frame = line.play.degrees_per_frame;
  BenchResult result;
  result.device = gl.info().renderer;
  result.version = gl.info().version;
  result.software = gl.info().software;
  result.width = line.render.width;
  result.height = line.render.height;
  result.map_resolution = line.render.map_resolution;
  result.interval = line.render.schedule.interval_frames;
  result.interval_degrees = line.render.schedule.interval_degrees;
  result.pcf = line.render.pcf;
  Result<BenchTimes> times = bench_times(renderer, line.play.light, options, context);
  if (!times.ok()) return times.status();
  result.times = std::move(*times);
  if (line.no_errors) return result;
  Result<std::vector<BenchError>> errors =
      bench_errors(renderer, line.play.light, options, context);
  if (!errors.ok()) return errors.status();
  result.errors = std::move(*errors);
  return result;
}

Status write_measured(const BenchResult& result, const std::filesystem::path& folder,
                      Terminal& terminal) {
  if (Status s = write_bench(result, folder); !s.ok()) return s;
  terminal.line(bench_table(result));
  terminal.line(
      fmt::format("wrote {} (gnuplot plots.gp there draws the figures)", folder.string()));
  return {};
}

// Refuses outputs that cannot be written, which would otherwise be noticed only after all frames
// are drawn.
Status check_outputs(const CommandLine& line) {
  const std::filesystem::path& picture = line.play.screenshot;
  if (!picture.empty() && lower_extension(picture) != ".png")
    return {ErrorCode::bad_option,
            fmt::format("{}: the screenshot must end in .png", picture.string())};
  if (Status s = check_output(picture, {line.scene}); !s.ok()) return s;
  for (const std::filesystem::path& folder : {line.play.record, line.bench}) {
    std::error_code error;  // errors are reported where the folder is made
    const auto there = std::filesystem::status(folder, error);
    if (std::filesystem::exists(there) && !std::filesystem::is_directory(there))
      return {ErrorCode::bad_option,
              fmt::format("{}: is a file (name a folder, which is made where there is none)",
                          folder.string())};
  }
  return {};
}

// Refuses pictures that would replace a file of the scene. Its textures, such as the pages of a
// world, are known only when it has been read.
Status check_files_stay(const CommandLine& line, const ViewScene& scene) {
  const bool may_record = line.in_window() || !line.play.record.empty();
  const auto film = may_record ? recorded_frame(line.play, 0).parent_path() : "";
  const auto picture = line.in_window() ? screenshot_file(line.play) : line.play.screenshot;
  for (const std::filesystem::path& file : scene.files) {
    if (Status s = check_output(picture, {file}); !s.ok()) return s;
    const std::filesystem::path name = file.filename();
    std::error_code error;  // a folder that is not there holds nothing
    if (may_record && lower_extension(name) == ".png" && name.string().starts_with("frame") &&
        std::filesystem::equivalent(film / name, file, error))
      return {ErrorCode::bad_option,
              fmt::format("{}: holds {}, which is read and a recording may replace (give the "
                          "recording another folder)",
                          film.string(), name.string())};
  }
  return {};
}

// Names the frames that a longer recording in the same folder has left: programs that read the
// folder as a film would append them.
void name_old_frames(const PlayOptions& options, int recorded, Terminal& terminal) {
  if (recorded == 0) return;
  const auto frame = [&](std::size_t f) { return recorded_frame(options, int(f)); };
  const auto old = files_there(std::size_t(recorded), frame);
  if (old.empty()) return;
  terminal.line(old_pages_text(old, "recording with more frames", "this one"));
}

// Tells how long a texel of the first maps is: shadows of thinner things are lost.
Status tell_reach(const CommandLine& line, const Renderer& renderer, Terminal& terminal) {
  const Result<MapReach> reach = renderer.map_reach(line.play.camera, line.play.light.direction(0));
  if (!reach.ok()) return reach.status();
  if (reach->texel <= 0) return {};
  const std::string far =
      reach->distance > 0
          ? fmt::format("{:.3g} units from the camera (--view-distance)", reach->distance)
          : std::string("everywhere");
  terminal.line(
      fmt::format("shadows reach {}; a map's texel is {:.3g} units long", far, reach->texel));
  return {};
}

// Where frames are drawn. `window` is the context, or null if there is no window.
struct Screen {
  std::unique_ptr<GlContext> gl;
  GlWindow* window = nullptr;
};

Result<Screen> open_screen(const CommandLine& line) {
  const ContextOptions wanted{line.debug, line.software};
  if (!line.in_window()) {
    auto made = make_headless_context(wanted);
    if (!made.ok()) return made.status();
    return Screen{std::move(made.value()), nullptr};
  }
  auto made =
      make_window(wanted, {line.render.width, line.render.height, "atlas-play", line.vsync, true});
  if (!made.ok()) return made.status();
  GlWindow* const window = made.value().get();
  return Screen{std::move(made.value()), window};
}

Status play(CommandLine& line, Terminal& terminal, const Context& context) {
  const bool headless = !line.in_window();
  // The march method works well with keys up to this far apart; a slow machine would otherwise
  // place them farther apart.
  constexpr double kWindowKeyDegrees = 16;
  line.render.schedule.max_key_degrees =
      line.key_degrees.value_or(headless ? kMaxKeyDegrees : kWindowKeyDegrees);
  if (Status s = check_outputs(line); !s.ok()) return s;
  // The scene is loaded first, so that a wrong file name does not open a window.
  ViewSceneOptions look;
  look.textures_hold_light = line.baked_textures;
  look.vertices_hold_colours = line.colours;
  Result<ViewScene> scene = load_view(line.scene, look, context, line.read);
  if (!scene.ok()) return scene.status();
  if (Status s = check_files_stay(line, *scene); !s.ok()) return s;
  scene->metres_per_unit = line.unit;
  // A world is already lit, and its reflectance is not known, so a sun would paint it white.
  const bool without_sun = scene->unlit == Unlit::all && !line.sun_asked;
  if (without_sun) line.render.shading = Shading::unlit;
  Result<Camera> camera = camera_of(line, *scene, context);
  if (!camera.ok()) return camera.status();
  line.play.camera = *camera;

  const Result<Screen> screen = open_screen(line);
  if (!screen.ok()) return screen.status();
  const auto& [gl, window] = *screen;
  Result<Renderer> renderer = Renderer::make(*scene, line.render);
  if (!renderer.ok()) return renderer.status();
  scene->lightmap.reset();  // up to gigabytes of floats, which the renderer has, too
  terminal.line(fmt::format("{} triangles, OpenGL {} on {}", scene->triangle_count(),
                            gl->info().version, gl->info().renderer));
  for (const std::string& text : renderer->plan()) terminal.line(text);
  if (Status s = tell_reach(line, *renderer, terminal); !s.ok()) return s;
  if (without_sun && line.bench.empty())
    terminal.line(
        "no sun: all materials are unlit, they hold the light already (--shading lambert adds "
        "one)");
  if (line.plan) return {};
  if (!line.bench.empty()) {
    Result<BenchResult> measured = measure(line, *gl, *renderer, context);
    if (Status s = gl->check_alive(); !s.ok()) return s;
    if (!measured.ok()) return measured.status();
    measured->triangles = std::uint32_t(scene->triangle_count());
    return write_measured(*measured, line.bench, terminal);
  }

  Result<PlaySummary> done = window ? play_in_window(*window, *renderer, line.play, context)
                                    : play_headless(*gl, *renderer, line.play, context);
  if (!done.ok()) return done.status();
  name_old_frames(line.play, done->recorded, terminal);
  terminal.line(fmt::format("{} frames, median {:.2f} ms, {} shadow maps begun", done->frames,
                            done->median_seconds * 1e3, done->shadow_passes));
  if (headless && line.play.screenshot.empty() && line.play.record.empty())
    terminal.line(
        "no picture was written (--screenshot FILE.png writes the last frame, --record FOLDER "
        "all)");
  return {};
}

}  // namespace
}  // namespace atlas::app

namespace {

int main_of(int argc, char** argv) {
  using namespace atlas::app;
  Parsed parsed = parse_command_line(argc, argv);
  if (parsed.exit_code) return *parsed.exit_code;
  name_input(parsed.line.scene);
  Terminal terminal("atlas-play", parsed.line.quiet);
  terminal.reword([](std::string_view text) { return with_flags(text, kTrustFlags); });
  const atlas::Status status = play(parsed.line, terminal, terminal.context(0));
  if (!status.ok()) terminal.error(status.message());
  return exit_code(status);
}

}  // namespace

int main(int argc, char** argv) {
  return atlas::app::run_program("atlas-play", argc, argv, main_of);
}
