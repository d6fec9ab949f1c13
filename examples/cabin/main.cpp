// atlas-make-cabin: a lit aircraft cabin with a wanted number of triangles, for demos, tests and
// measurements that need realistic work without a download.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cmath>
#include <filesystem>
#include <string>
#include <string_view>

#include "apps/common/files.h"
#include "apps/common/options.h"
#include "apps/common/program.h"
#include "apps/common/terminal.h"
#include "examples/cabin/lit_cabin.h"
#include "examples/cabin/preview.h"
#include "examples/cabin/write.h"
#include "libatlas/core/clock.h"

namespace {

using atlas::app::within;

struct Arguments {
  std::size_t triangles = 100000;
  std::string output, preview, up = "z";
  cabin::LightingOptions lighting;
  int samples = 0, threads = 0, preview_width = 1280;
  bool quiet = false;
};

void describe(CLI::App& app, Arguments& a) {
  app.add_option("-n,--triangles", a.triangles, "how many triangles, met within 3 %")
      ->check(within(10000, 20000000))
      ->capture_default_str();
  app.add_option("-o,--output", a.output, "the scene to write: .obj, .ply or .glb");
  app.add_option("--preview", a.preview, "a picture of it from inside, .png");
  app.add_option("--preview-width", a.preview_width, "pixels; the height is 9/16 of it")
      ->check(within(16, 8192))
      ->capture_default_str();
  app.add_option("--seed", a.lighting.seed, "of the sampling pattern")->capture_default_str();
  app.add_option("--samples", a.samples,
                 "shadow rays a vertex (default: 192 up to 200 k triangles, 96 to 1.2 M, then 64)")
      ->check(within(1, 4096));
  app.add_option("--indirect-samples", a.lighting.indirect_samples,
                 "hemisphere rays a vertex of the coarse mesh, for the light between surfaces")
      ->check(within(1, 4096))
      ->capture_default_str();
  app.add_option("--up", a.up, "the axis that points up")
      ->check(atlas::app::one_of({{"y", 0}, {"z", 0}}))
      ->type_name("AXIS")
      ->capture_default_str();
  app.add_option("--threads", a.threads, "0: as many as there are cores; the files are the same")
      ->check(within(0, 1024))
      ->capture_default_str();
  app.add_flag("-q,--quiet", a.quiet, "print warnings and errors only");
}

// Checks the arguments before minutes of work.
atlas::Status check(const Arguments& a) {
  if (a.output.empty() && a.preview.empty())
    return {atlas::ErrorCode::bad_option,
            "nothing to write (give -o FILE, --preview FILE or both)"};
  if (!a.preview.empty() && std::filesystem::path(a.preview).extension() != ".png")
    return {atlas::ErrorCode::bad_option, a.preview + ": the preview must end in .png"};
  if (atlas::Status s = a.output.empty() ? atlas::Status() : cabin::check_scene_path(a.output);
      !s.ok())
    return s;
  return atlas::app::check_output(a.preview, {a.output});
}

// Refuses a preview that would overwrite a texture beside the scene.
atlas::Status check_textures_stay(const Arguments& a, const cabin::Mesh& mesh) {
  if (a.output.empty() || a.preview.empty()) return {};
  const std::filesystem::path output = std::filesystem::absolute(a.output);
  if (output.extension() == ".ply") return {};  // a .ply has no textures
  const std::filesystem::path preview = std::filesystem::absolute(a.preview);
  std::error_code error;
  for (const cabin::SurfaceMaterial& m : mesh.materials)
    if (preview.filename() == m.texture_file &&
        std::filesystem::equivalent(preview.parent_path(), output.parent_path(), error))
      return {atlas::ErrorCode::bad_option,
              a.preview + ": is the name of a texture of the scene (give the preview another)"};
  return {};
}

atlas::Status run(const Arguments& a, atlas::app::Terminal& terminal) {
  if (atlas::Status s = check(a); !s.ok()) return s;
  const atlas::Context context = terminal.context(a.threads);
  const double start = atlas::cpu_seconds();
  const auto say = [&](std::string_view line) {
    terminal.line(fmt::format("{:7.1f} s  {}", atlas::cpu_seconds() - start, line));
  };
  cabin::Mesh mesh = cabin::coarse_cabin(a.triangles, context);
  if (context.cancelled()) return atlas::Status::cancelled();
  if (atlas::Status s = check_textures_stay(a, mesh); !s.ok()) return s;
  say(fmt::format("coarse mesh: {} triangles, {} vertices, {} objects", mesh.triangles.size(),
                  mesh.vertices.size(), mesh.objects.size()));
  atlas::Context lighting = context;
  lighting.warn = say;  // reports its steps
  cabin::light_cabin(mesh, a.triangles, a.lighting, lighting);
  if (context.cancelled()) return atlas::Status::cancelled();
  if (std::abs(double(mesh.triangles.size()) / double(a.triangles) - 1) > 0.03)
    return {atlas::ErrorCode::no_solution,
            fmt::format("{} triangles came out instead of {} (ask for more)", mesh.triangles.size(),
                        a.triangles)};
  if (!a.output.empty()) {
    const atlas::Status status = cabin::write_scene(a.output, mesh, a.up == "y", context);
    if (!status.ok()) return status;
    say("wrote " + a.output);
  }
  if (!a.preview.empty()) {
    const cabin::PreviewOptions options{a.preview_width, a.preview_width * 9 / 16, 3};
    const atlas::Status status = cabin::write_preview(a.preview, mesh, options, context);
    if (!status.ok()) return status;
    say("wrote " + a.preview);
  }
  return {};
}

int main_of(int argc, char** argv) {
  CLI::App app("Makes a lit aircraft cabin: a scene for atlas-export, of any size.",
               "atlas-make-cabin");
  Arguments arguments;
  describe(app, arguments);
  if (const int code = atlas::app::parse(app, argc, argv); code >= 0) return code;
  arguments.lighting.direct_samples =
      arguments.samples > 0 ? arguments.samples : cabin::default_samples(arguments.triangles);
  atlas::app::Terminal terminal("atlas-make-cabin", arguments.quiet);
  const atlas::Status status = run(arguments, terminal);
  if (!status.ok()) terminal.error(status.message());
  return atlas::app::exit_code(status);
}

}  // namespace

int main(int argc, char** argv) {
  return atlas::app::run_program("atlas-make-cabin", argc, argv, main_of);
}
