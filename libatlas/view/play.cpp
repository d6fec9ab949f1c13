#include "libatlas/view/play.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "libatlas/core/clock.h"
#include "libatlas/exporters/world.h"
#include "libatlas/files/file_extension.h"
#include "libatlas/scene/named_materials.h"
#include "libatlas/scene/reader.h"
#include "libatlas/view/bench.h"
#include "libatlas/view/picture_file.h"

namespace atlas {
namespace fs = std::filesystem;

bool world_is_z_up(const fs::path& path) {
  std::error_code error;
  const std::string extension = lower_extension(path);
  if (extension != ".wrl" && extension != ".wrz" && extension != ".obj") return false;
  if (!fs::is_regular_file(path, error)) return false;
  std::string head(4096, '\0');                    // WorldInfo and comments come first
  const gzFile file = gzopen(path.c_str(), "rb");  // reads plain text, too
  if (!file) return false;
  const int got = gzread(file, head.data(), unsigned(head.size()));
  gzclose(file);
  head.resize(std::size_t(std::max(got, 0)));
  return head.find(kZUpNote) != std::string::npos;
}

namespace {

void say_what_is_dark(const Scene& scene, const Context& context) {
  NamedMaterials screens;
  for (const Material& m : scene.materials)
    if (m.emission_textured && m.emission != Vec3f{}) screens.add(m);
  if (screens.count == 0) return;
  context.say(
      fmt::format("{} {} light by a texture: it is not shown, only emission of one colour is (give "
                  "such parts materials with a plain Ke or emissiveFactor)",
                  screens.text(), screens.count == 1 ? "emits" : "emit"));
}

// Returns whether something should be seen through the material, other than through holes.
bool is_transparent(const Material& m, const Scene& scene) {
  const bool alpha =
      m.texture >= 0 && scene.textures[std::size_t(m.texture)].image.channels % 2 == 0;
  return m.opacity_textured || m.opacity_by_view ||
         (m.alpha_mode == AlphaMode::blend && (m.opacity < 1 || alpha));
}

void say_what_is_opaque(const Scene& scene, const Context& context) {
  NamedMaterials panes;
  for (const Material& m : scene.materials)
    if (is_transparent(m, scene)) panes.add(m);
  if (panes.count == 0) return;
  context.say(fmt::format(
      "{} {} transparent: shown opaque (where the opacity is below 0.5, without a shadow)",
      panes.text(), panes.count == 1 ? "is" : "are"));
}

}  // namespace

Result<ViewScene> load_view(const fs::path& path, const ViewSceneOptions& options,
                            const Context& context, const ReadOptions& read) {
  ReadOptions all;
  all.confine = read.confine;
  all.limits = read.limits;
  all.srgb_colours = options.vertices_hold_colours;
  all.lightmap = true;
  Result<LoadedScene> loaded = read_scene(path, all, context);
  if (!loaded.ok()) return loaded.status();
  for (const std::string& line : loaded->defects.lines()) context.say("defect: " + line);
  say_what_is_dark(loaded->scene, context);
  say_what_is_opaque(loaded->scene, context);
  Result<ViewScene> view = make_view_scene(loaded->scene, options, context);
  if (view.status().code() == ErrorCode::cancelled) return view.status();
  if (!view.ok())
    return Status{view.status().code(), path.string() + ": " + view.status().message()};
  view->start = loaded->view;
  view->files = std::move(loaded->files);
  view->files.insert(view->files.end(), loaded->unread_files.begin(), loaded->unread_files.end());
  return view;
}

fs::path recorded_frame(const PlayOptions& options, int frame) {
  const fs::path folder = options.record.empty() ? "recording" : options.record;
  return folder / fmt::format("frame{:05}.png", frame);
}

fs::path screenshot_file(const PlayOptions& options) {
  return options.screenshot.empty() ? "screenshot.png" : options.screenshot;
}

Result<PlaySummary> play_headless(GlContext& gl, Renderer& renderer, const PlayOptions& options,
                                  const Context& context) {
  if (!options.record.empty()) {
    std::error_code error;
    fs::create_directories(options.record, error);
    if (error)
      return Status{ErrorCode::io, fmt::format("{}: the folder cannot be made ({})",
                                               options.record.string(), error.message())};
  }
  PlaySummary summary;
  const std::int64_t errors_before = gl.debug_errors();
  std::vector<double> times;
  for (int f = 0; f < options.frames; ++f) {
    if (context.cancelled()) return Status::cancelled();
    const double step = options.degrees_per_frame, start = wall_seconds();
    const FrameLight light{options.light.direction(f * step),
                           [&](int n) { return options.light.direction((f + n) * step); }};
    Result<FrameStats> stats = renderer.draw(options.camera, light);
    renderer.finish();
    if (Status s = gl.check_alive(); !s.ok()) return s;  // it explains whatever else failed
    if (!stats.ok()) return stats.status();
    times.push_back(wall_seconds() - start);
    if (!options.record.empty()) {
      const fs::path file = recorded_frame(options, f);
      if (Status s = write_picture(file, renderer.read_image()); !s.ok()) return s;
      ++summary.recorded;
    }
    context.report("frames", double(f + 1) / options.frames);
  }
  if (!options.screenshot.empty())
    if (Status s = write_picture(options.screenshot, renderer.read_image()); !s.ok()) return s;
  summary.frames = options.frames;
  summary.shadow_passes = renderer.shadow_passes();
  summary.gl_errors = gl.debug_errors() - errors_before;
  summary.median_seconds = spread_of(times).p50;
  if (summary.gl_errors > 0)
    return Status{ErrorCode::bad_input, fmt::format("OpenGL: {} errors, the first: {}",
                                                    summary.gl_errors, gl.first_debug_error())};
  return summary;
}

}  // namespace atlas
