#include "apps/atlas-play/command_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>

#include "apps/common/options.h"
#include "apps/common/program.h"
#include "apps/common/quantity.h"
#include "libatlas/files/parse_number.h"
#include "libatlas/view/start_camera.h"

namespace atlas::app {
namespace {

constexpr int kWindowWidth = 1280, kWindowHeight = 800;  // the panel takes 450 x 600 of it

const std::map<std::string, ShadowMethod>& methods() {
  static const std::map<std::string, ShadowMethod> map = [] {
    std::map<std::string, ShadowMethod> m;
    for (ShadowMethod method : kAllMethods) m[name_of(method)] = method;
    return m;
  }();
  return map;
}

const std::map<std::string, Shading>& shadings() {
  static const std::map<std::string, Shading> map{{"unlit", Shading::unlit},
                                                  {"lambert", Shading::lambert},
                                                  {"blinn-phong", Shading::blinn_phong},
                                                  {"ward", Shading::ward}};
  return map;
}

void add_picture_options(CLI::App& app, CommandLine& l) {
  const OptionGroup group(app, "Picture");
  app.add_option("--width", l.render.width, "pixels (default: 1280 in a window, else 640)")
      ->check(within(1, 16384));
  app.add_option("--height", l.render.height, "pixels (default: 800 in a window, else 400)")
      ->check(within(1, 16384));
  app.add_option("--camera", l.camera, "where from and where to: x,y,z;x,y,z");
  app.add_option_function<std::string>(
         "--unit",
         [&l](const std::string& text) {
           const std::optional<double> unit = parse_unit(text);
           if (!unit)
             throw CLI::ValidationError(
                 "--unit",
                 fmt::format("{}: give m, cm, mm, in, ft, km or metres (1e-12 to 1e24)", text));
           l.unit = *unit;
         },
         "length of one scene unit, for the eye's height: m, cm, mm, in, ft, km or metres")
      ->default_str("m");
  app.add_option("--quantity", l.colours,
                 "what the vertices carry: illuminance (reflectance still to apply), or colour "
                 "(sRGB, as scans have; the surface's reflectance)")
      ->transform(choices<bool>({{"illuminance", false}, {"colour", true}}))
      ->type_name("NAME")
      ->default_str("illuminance");
  app.add_option("--fov", l.fov, "vertical field of view, degrees")
      ->check(within(1, 170))
      ->capture_default_str();
  app.add_option("--shading", l.render.shading,
                 "unlit, lambert, blinn-phong or ward (default: unlit for worlds and others all of "
                 "whose materials are unlit, unless --sun, --light, --shadows or --visibility is "
                 "given; else lambert)")
      ->transform(choices(shadings()))
      ->type_name("NAME");
  app.add_option("--ambient", l.render.ambient, "light that no shadow darkens")
      ->capture_default_str()
      ->check(not_negative());
  app.add_option("--sun", l.render.intensity, "strength of the moving light")
      ->capture_default_str()
      ->check(not_negative());
  app.add_option("--baked-light", l.render.baked_strength, "factor on the light in the file")
      ->capture_default_str()
      ->check(not_negative());
  app.add_option("--exposure", l.render.exposure, "factor on all light")
      ->capture_default_str()
      ->check(positive());
  app.add_option("--specular", l.render.specular, "strength of the highlight")
      ->capture_default_str()
      ->check(not_negative());
  app.add_option("--shininess", l.render.shininess, "Blinn-Phong's exponent")
      ->capture_default_str()
      ->check(positive());
  app.add_option("--roughness", l.render.roughness, "Ward's alpha")
      ->capture_default_str()
      ->check(positive());
  app.add_flag("--visibility", l.render.show_visibility, "show the light's visibility as grey");
  app.add_flag_callback(
         "--baked-textures", [&l] { l.baked_textures = true; },
         "the textures hold light (default: those of unlit materials, as worlds have)")
      ->excludes(app.add_flag_callback(
          "--no-baked-textures", [&l] { l.baked_textures = false; }, "they hold colours"));
}

void add_shadow_options(CLI::App& app, CommandLine& l) {
  const OptionGroup group(app, "Shadows");
  app.add_option("--shadows", l.render.shadows,
                 "none, classic, hold, linear, slerp, slerp-normalised or march")
      ->transform(choices(methods()))
      ->type_name("NAME")
      ->default_str("march");
  app.add_option("--map", l.render.map_resolution, "texels a side of a shadow map")
      ->capture_default_str()
      ->check(within(16, 32768));
  app.add_option("--map-bits", l.render.map_bits, "of a map's depths: 16, 24, or 32 (floats)")
      ->check(one_of({{"16", 16}, {"24", 24}, {"32", 32}}))
      ->capture_default_str();
  app.add_option("--pcf", l.render.pcf, "filter: 0 nearest, 1 bilinear, 3 or 5 taps a side")
      ->check(one_of({{"0", 0}, {"1", 1}, {"3", 3}, {"5", 5}}))
      ->capture_default_str();
  app.add_option("--march-steps", l.render.march_steps, "samples along the ray")
      ->capture_default_str()
      ->check(within(1, 64));
  app.add_option("--slope-bias", l.render.slope_bias, "in depth slopes over the filter's reach")
      ->capture_default_str()
      ->check(not_negative());
  app.add_option("--normal-offset", l.render.normal_offset, "in reaches of the filter")
      ->capture_default_str()
      ->check(not_negative());
  CLI::Option* fit =
      app.add_flag("--fit-view", l.render.fit_view, "fit maps to the view, not the whole scene");
  app.add_option("--view-distance", l.render.view_distance,
                 "how far from the camera shadows reach with --fit-view, in scene units (default: "
                 "beyond nine tenths of the vertices)")
      ->needs(fit)
      ->check(not_negative());
  add_off_flag(app, "--no-snap", l.render.snap, "do not snap maps to whole texels");
  app.add_option("-k,--interval", l.render.schedule.interval_frames, "frames between keys")
      ->capture_default_str()
      ->check(within(1, 1'000'000));
  app.add_option("--interval-degrees", l.render.schedule.interval_degrees,
                 "keys every so many degrees instead")
      ->excludes("--interval")
      ->check(within(0, 90, "0..90"));
  app.add_option("--key-degrees", l.key_degrees,
                 "keys at most so far apart (default: 16 in a window, 90 headless)")
      ->check(within(0.01, 90, "0.01..90"));
  add_off_flag(app, "--no-slices", l.render.schedule.sliced, "draw a key in one frame");
}

enum class Axis { x, y, z };

// What becomes the light's path once all options are known.
struct LightText {
  std::string path = "sun:172,50.45,9";
  PathEnd end = PathEnd::loop;
  Axis up = Axis::y;
};

void add_light_options(CLI::App& app, CommandLine& l, LightText& light) {
  const OptionGroup group(app, "Moving light");
  const std::map<std::string, PathEnd> ends = {
      {"loop", PathEnd::loop}, {"back", PathEnd::back}, {"stop", PathEnd::stop}};
  const std::map<std::string, Axis> axes = {{"x", Axis::x}, {"y", Axis::y}, {"z", Axis::z}};
  app.add_option("--light", light.path,
                 "sun:DAY,LATITUDE,HOUR  fixed:x,y,z  line:x,y,z;x,y,z  arc:x,y,z;x,y,z  "
                 "keys:x,y,z;x,y,z;...")
      ->capture_default_str();
  app.add_option("--light-end", light.end, "at the path's end: loop, back or stop")
      ->transform(choices(ends))
      ->type_name("TEXT")
      ->default_str("loop");
  app.add_option("--up", light.up, "the axis that points up (default: z for files that say so)")
      ->transform(choices(axes))
      ->type_name("TEXT")
      ->default_str("y");
  app.add_option("--north", l.north,
                 "the sun's north, x,y,z (default: -z where y is up, +y where x or z is)")
      ->delimiter(',')
      ->expected(3);
  app.add_option("--speed", l.play.degrees_per_second, "degrees a second, in a window")
      ->capture_default_str()
      ->check(within(0, 1e6));
  app.add_option("--max-step", l.play.max_step, "degrees a frame at most, in a window")
      ->check(within(0.001, 90, "0.001..90"))
      ->capture_default_str();
  app.add_option("--step", l.play.degrees_per_frame, "degrees a frame, headless and in the bench")
      ->capture_default_str()
      ->check(within(0, 90));
}

void add_run_options(CLI::App& app, CommandLine& l) {
  const OptionGroup group(app, "Running");
  app.add_flag("--headless", l.headless, "no window");
  app.add_flag("--software", l.software, "headless: do not use a GPU");
  app.add_option("--frames", l.play.frames, "headless: how many")
      ->check(within(1, 1'000'000))
      ->capture_default_str();
  app.add_option("--close-after", l.play.close_after, "in a window: end after so many frames")
      ->check(within(1, 1'000'000'000));
  app.add_option("--record", l.play.record, "write every frame to this folder");
  app.add_option("--screenshot", l.play.screenshot,
                 "write the last frame to this PNG file (in a window: F12 does)");
  add_trust_options(app, l.read);
  app.add_flag("--plan", l.plan, "print what is compiled and allocated, and why, and end");
  add_off_flag(app, "--no-vsync", l.vsync, "do not wait for the display");
  app.add_flag("--debug", l.debug, "a debug context: every OpenGL error is reported");
  app.add_flag("-q,--quiet", l.quiet, "print warnings and errors only");
}

void add_bench_options(CLI::App& app, CommandLine& l) {
  const OptionGroup group(app, "Measuring");
  CLI::Option* bench =
      app.add_option("--bench", l.bench, "measure every shading with every method; results go here")
          ->excludes("--record")
          ->excludes("--screenshot");
  app.add_option("--bench-seconds", l.measure.seconds,
                 "of each combination at least (the paper: 180)")
      ->needs(bench)
      ->check(not_negative());
  app.add_option("--bench-frames", l.measure.frames, "of each combination at least")
      ->needs(bench)
      ->capture_default_str()
      ->check(within(1, 1'000'000));
  app.add_option("--bench-shadings", l.measure.shadings, "which shadings")
      ->needs(bench)
      ->delimiter(',')
      ->transform(choices(shadings()))
      ->type_name("NAME");
  app.add_option("--bench-methods", l.measure.methods, "which shadow methods")
      ->needs(bench)
      ->delimiter(',')
      ->transform(choices(methods()))
      ->type_name("NAME");
  app.add_option("--bench-intervals", l.measure.error_intervals, "k of the error measurement")
      ->needs(bench)
      ->delimiter(',')
      ->capture_default_str()
      ->check(within(1, 1'000'000));
  app.add_option("--bench-error-frames", l.measure.error_frames, "light positions")
      ->needs(bench)
      ->capture_default_str()
      ->check(within(1, 1'000'000));
  app.add_flag("--no-errors", l.no_errors, "measure times only")->needs(bench);
}

// Returns a complaint about options that would change nothing, such as those for the other way of
// running.
std::string about_running(const CLI::App& app, const CommandLine& l) {
  if (l.plan && l.quiet) return "--plan with --quiet tells nothing (leave one out)";
  for (const char* output : {"--screenshot", "--record", "--bench"})
    if (l.plan && app.count(output) > 0)
      return fmt::format("--plan draws nothing, so {} would stay empty (leave one out)", output);
  for (const char* count : {"--frames", "--close-after"})
    if (!l.bench.empty() && app.count(count) > 0)
      return fmt::format("{} is not for --bench (give --bench-frames)", count);
  if (!l.bench.empty() && app.count("--shading") > 0)
    return "--shading is not for --bench (give --bench-shadings)";
  if (!l.bench.empty() && app.count("--shadows") > 0)
    return "--shadows is not for --bench (give --bench-methods)";
  if (!l.bench.empty() && app.count("--visibility") > 0)
    return "--visibility is not for --bench, which measures it and colours (leave one out)";
  if (l.in_window() && l.software)
    return "--software is for --headless (give that too; a window uses the display's driver)";
  if (l.in_window() && app.count("--frames") > 0)
    return "--frames is for --headless (give that too, or --close-after for a window)";
  if (l.headless && app.count("--close-after") > 0)
    return "--close-after is for a window (with --headless give --frames)";
  return {};
}

// Interprets the texts that CLI11 cannot turn into their values itself.
Status finish(CommandLine& l, const LightText& light) {
  constexpr std::array<Vec3d, 3> kAxes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  l.render.up = kAxes[static_cast<std::size_t>(light.up)];
  LightPathOptions path;
  path.sun.up = l.render.up;
  path.sun.north = light.up == Axis::y ? Vec3d{0, 0, -1} : Vec3d{0, 1, 0};
  if (l.north.size() == 3) path.sun.north = {l.north[0], l.north[1], l.north[2]};
  path.end = light.end;
  Result<LightPathOptions> parsed = parse_light_path(light.path, path);
  const Result<LightPath> made = parsed.ok() ? LightPath::make(*parsed) : parsed.status();
  if (!made.ok()) {  // "light path 'moon': ..." or "light path: ..."
    const std::string& why = made.status().message();
    return {made.status().code(), fmt::format("--light {}{}", light.path,
                                              why.substr(std::min(why.find(": "), why.size())))};
  }
  l.play.light = *made;
  return {};
}

// Reads "x,y,z;x,y,z". Returns false if the text contains anything else.
bool two_points(const std::string& text, Vec3d& a, Vec3d& b) {
  constexpr std::string_view kBehind = ",,;,,";
  double* const values[] = {&a.x, &a.y, &a.z, &b.x, &b.y, &b.z};
  const char *p = text.data(), *const end = p + text.size();
  for (std::size_t i = 0; i < 6; ++i) {
    while (*p == ' ') ++p;
    p = parse_number(p, end, *values[i]);
    if (p == nullptr) return false;
    if (i < kBehind.size() && *p++ != kBehind[i]) return false;
  }
  return p == end;
}

}  // namespace

Result<Camera> camera_of(const CommandLine& line, const ViewScene& scene, const Context& context) {
  if (line.camera.empty()) {
    const Camera camera = start_camera(scene, line.render.up, line.fov, context);
    return context.cancelled() ? Result<Camera>(Status::cancelled()) : camera;
  }
  Camera camera = camera_for(scene.bounds, line.render.up, line.fov);
  Vec3d a, b;
  if (!two_points(line.camera, a, b) || a == b || !std::isfinite(a.x + a.y + a.z + b.x + b.y + b.z))
    return Status{ErrorCode::bad_option,
                  fmt::format("--camera {}: give two different points, x,y,z;x,y,z", line.camera)};
  const Vec3d& o = scene.origin;
  camera.eye = {a.x - o.x, a.y - o.y, a.z - o.z};
  camera.target = {b.x - o.x, b.y - o.y, b.z - o.z};
  fit_planes(camera, scene.bounds);
  return camera;
}

Parsed parse_command_line(int argc, char** argv) {
  Parsed parsed;
  CommandLine& l = parsed.line;
  CLI::App app{"Shows a scene, and atlases with baked light, under a moving light with shadows.",
               "atlas-play"};
  LightText light;
  app.add_option("scene", l.scene, "OBJ, PLY, OFF, STL, glTF, GLB, VRML")->required();
  app.set_config("--config", "", "options from a file");
  app.allow_config_extras(CLI::config_extras_mode::error);
  add_picture_options(app, l);
  add_shadow_options(app, l);
  add_light_options(app, l, light);
  add_run_options(app, l);
  add_bench_options(app, l);
  constexpr std::pair<const char*, const char*> examples[] = {
      {"Walk through an exported world", "world.wrl"},
      {"A model under the sun of a day in June, in Lisbon", "model.glb --light sun:172,38.7,9"},
      {"A picture without a window or a graphics card",
       "world.wrl --headless --software --screenshot picture.png"}};
  add_examples(app, examples);
  if (const int code = parse(app, argc, argv); code >= 0) {
    parsed.exit_code = code;
    return parsed;
  }
  if (const std::string why = about_running(app, l); !why.empty()) {
    print_error("atlas-play", why);
    parsed.exit_code = 2;
    return parsed;
  }
  for (const char* option : {"--shading", "--sun", "--light", "--shadows", "--visibility"})
    l.sun_asked |= app.count(option) > 0;
  if (app.count("--up") == 0 && world_is_z_up(l.scene)) light.up = Axis::z;
  if (l.in_window() && app.count("--width") == 0) l.render.width = kWindowWidth;
  if (l.in_window() && app.count("--height") == 0) l.render.height = kWindowHeight;
  if (Status s = finish(l, light); !s.ok()) {
    print_error("atlas-play", s.message());
    parsed.exit_code = 2;
  }
  return parsed;
}

}  // namespace atlas::app
