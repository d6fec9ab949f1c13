// Runs the player: without a window for pictures and tests, or in one.
#pragma once

#include <cstdint>
#include <filesystem>

#include "libatlas/core/context.h"
#include "libatlas/scene/reader.h"
#include "libatlas/shadow/light_path.h"
#include "libatlas/view/context.h"
#include "libatlas/view/renderer.h"

namespace atlas {

// Returns whether a file is a VRML or OBJ file that says at its beginning that its z axis points up
// (kZUpNote). Returns false if the file cannot be read.
bool world_is_z_up(const std::filesystem::path& path);

// Reads the scene at `path` and returns arrays to draw. Errors: those of the readers; bad_input if
// nothing is drawn. Reports through the context what the readers left out or replaced, and what is
// not shown. Of `read`, only `confine` and `limits` count; colours at the vertices
// (ViewSceneOptions::vertices_hold_colours) are read as sRGB.
Result<ViewScene> load_view(const std::filesystem::path& path, const ViewSceneOptions& options,
                            const Context& context, const ReadOptions& read = {});

struct PlayOptions {
  LightPath light = {};
  Camera camera = {};              // the camera at the start
  double degrees_per_frame = 0.5;  // headless
  double degrees_per_second = 15;  // in a window
  double max_step = 2;             // in a window: most degrees per frame, see LightClock
  int frames = 1;                  // headless: how many are drawn
  int close_after = 0;             // in a window: frames until it closes by itself; 0: never
  // A folder for frame00000.png and so on (recorded_frame()). Empty: nothing is recorded; in a
  // window, its panel can start a recording in "recording".
  std::filesystem::path record = {};
  // PNG file; empty: none. Headless, it gets the last frame; in a window, what F12 takes, and what
  // was last shown before close_after.
  std::filesystem::path screenshot = {};
};

// Returns the name of a recording's frame, counted from 0.
std::filesystem::path recorded_frame(const PlayOptions& options, int frame);

// Returns the name of the file that F12 writes in a window.
std::filesystem::path screenshot_file(const PlayOptions& options);

struct PlaySummary {
  int frames = 0;
  std::int64_t shadow_passes = 0;
  std::int64_t gl_errors = 0;  // reported by the driver; counted in debug contexts
  double median_seconds = 0;   // per frame, wall-clock time
  int recorded = 0;            // frames that were written
};

// Draws options.frames frames. Fails with the first GL error, if the context is lost
// (GlContext::check_alive), or if cancelled.
Result<PlaySummary> play_headless(GlContext& gl, Renderer& renderer, const PlayOptions& options,
                                  const Context& context);

// Shows the scene until the window is closed, with a free camera (drag, WASD, QE), panels for every
// setting, a graph of frame times, screenshots (F12) and recording; a panel lists the keys. Errors:
// `cancelled`; `unsupported` if the context is lost, or if the display server goes while the window
// is open. In the latter case, end the program without destroying what belongs to the context,
// since the driver talks to that server.
Result<PlaySummary> play_in_window(GlWindow& window, Renderer& renderer, const PlayOptions& options,
                                   const Context& context);

}  // namespace atlas
