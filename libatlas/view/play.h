// Runs the player: without a window for pictures and tests, or in one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "libatlas/core/context.h"
#include "libatlas/shadow/light_path.h"
#include "libatlas/view/context.h"
#include "libatlas/view/renderer.h"

namespace atlas {

// Whether a file's textures hold light instead of reflectance: VRML worlds (what atlas-export
// writes), and glTF whose materials are unlit. False if the file cannot be read.
bool textures_hold_light(const std::filesystem::path& path);

// Whether a file is a VRML world that says so of its z axis. False if the file cannot be read.
bool world_is_z_up(const std::filesystem::path& path);

// The scene at `path` as arrays to draw; the readers' errors, or bad_input if nothing is drawn.
// What the readers left out or replaced is said through the context.
Result<ViewScene> load_view(const std::filesystem::path& path, bool baked_textures,
                            const Context& context);

struct PlayOptions {
  LightPath light;
  Camera camera;                     // where it starts
  double degrees_per_frame = 0.5;    // headless
  double degrees_per_second = 15;    // in a window
  double max_step = 2;               // in a window: degrees a frame, see LightClock
  int frames = 1;                    // headless: how many are drawn
  int close_after = 0;               // in a window: frames until it closes by itself; 0: never
  std::filesystem::path record;      // a folder for frame00000.png and on; empty: none
  std::filesystem::path screenshot;  // PNG: headless the last frame, else what F12 takes and what
                                     // was last shown before close_after; empty: none
};

struct PlaySummary {
  int frames = 0;
  std::int64_t shadow_passes = 0;
  std::int64_t gl_errors = 0;  // reported by the driver; counted in debug contexts
  double median_seconds = 0;   // of a frame, wall clock
};

// Draws options.frames frames. Fails with the first GL error, when the context is lost
// (GlContext::check_alive), or when cancelled.
Result<PlaySummary> play_headless(GlContext& gl, Renderer& renderer, const PlayOptions& options,
                                  const Context& context);

// Shows the scene until the window is closed: free camera (drag, WASD, QE), panels for every
// setting, a graph of frame times, screenshots (F12) and recording; a panel lists the keys.
// `unsupported` if the context is lost, or if the display server goes while the window is open:
// then end the program without destroying what belongs to the context, since the driver talks to
// that server.
Result<PlaySummary> play_in_window(GlWindow& window, Renderer& renderer, const PlayOptions& options,
                                   const Context& context);

}  // namespace atlas
