// The player's command line.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libatlas/view/bench.h"
#include "libatlas/view/play.h"

namespace atlas::app {

struct CommandLine {
  std::filesystem::path scene;
  bool headless = false, software = false, plan = false, quiet = false, debug = false;
  bool vsync = true;
  std::optional<bool> baked_textures;  // nothing: chosen by the file
  std::filesystem::path bench;         // a folder; empty: no bench
  bool sun_asked = false;              // an option about shading or the light is given
  bool colours = false;                // the vertices hold colours, not light
  bool no_errors = false;              // bench: times only
  double unit = 1;                     // metres per scene unit
  std::string camera;                  // "x,y,z;x,y,z"; empty: see camera_of()
  double fov = 60;
  std::optional<double> key_degrees;  // nothing: 16 in a window, 90 without
  std::vector<double> north;          // of the sun; empty: chosen by the up axis
  ReadOptions read;                   // confine and limits
  RenderOptions render;
  BenchOptions measure;
  PlayOptions play;

  bool in_window() const { return !headless && bench.empty() && !plan; }
};

// The command line, or an exit code if the help or a complaint has been printed.
struct Parsed {
  CommandLine line;
  std::optional<int> exit_code;
};
Parsed parse_command_line(int argc, char** argv);

// Returns the camera of "eye;target", or, if that is empty, the one where a visitor would enter the
// scene (start_camera()). Errors: bad_option if the text is something else; cancelled.
Result<Camera> camera_of(const CommandLine& line, const ViewScene& scene,
                         const Context& context = {});

}  // namespace atlas::app
