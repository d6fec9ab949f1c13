// OpenGL 4.5 core contexts: without a window through EGL (which works on Mesa's software renderer
// and needs no display), or in a GLFW window. Like GLFW, windows may be used on the main thread
// only: this applies to make_window(), every member of a window, its destructor, and
// play_in_window().
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "libatlas/core/status.h"

struct GLFWwindow;

namespace atlas {

struct GlInfo {
  std::string renderer = {}, version = {};
  bool software = false;  // the renderer is Mesa's llvmpipe, softpipe or swrast
};

// Returns whether the current context draws on the CPU, as GlInfo::software says.
bool draws_in_software();

// A context that is current on the thread that made it, from construction to destruction.
class GlContext {
 public:
  virtual ~GlContext() = default;
  const GlInfo& info() const { return info_; }
  // Errors that the driver has reported through KHR_debug since construction, and the first of
  // them. They are counted only in contexts made with debug == true.
  std::int64_t debug_errors() const { return debug_errors_; }
  const std::string& first_debug_error() const { return first_debug_error_; }

  void note_debug_error(const char* message);

  // Returns `unsupported` with the reason once the driver has reset this context (because a shader
  // ran too long, another program failed, or a GPU was removed): nothing drawn since then is shown,
  // and only a new context helps. Call it once per frame. Always ok if the driver does not report
  // resets.
  Status check_alive() const;
  // Stands in for the driver: returns what glGetGraphicsResetStatus would. For tests, since a
  // software renderer is never reset.
  void set_reset_source(std::function<unsigned()> source) { reset_source_ = std::move(source); }

 protected:
  // Reads info_, checks the version and installs the debug callback, which keeps `this`: the object
  // must not move.
  Status initialise(bool debug);
  GlInfo info_;
  std::int64_t debug_errors_ = 0;
  std::string first_debug_error_;
  std::function<unsigned()> reset_source_;
};

struct ContextOptions {
  bool debug = false;     // a debug context: slower, reports errors with text
  bool software = false;  // headless only: do not look for a GPU
};

// Makes a context without any surface, which draws into framebuffer objects. Prefers a GPU's
// device, then Mesa's surfaceless platform. Error: `unsupported` with the reason if there is
// neither.
Result<std::unique_ptr<GlContext>> make_headless_context(const ContextOptions& options);

struct WindowOptions {
  int width = 1280, height = 800;
  std::string title = "atlas-play";
  bool vsync = true;
  bool visible = true;
};

class GlWindow : public GlContext {
 public:
  virtual GLFWwindow* handle() = 0;
  // Returns whether the display server has gone. Then no window of the process can show anything
  // any more, nor can new ones be made, and the window is not closed but left behind.
  virtual bool lost() const = 0;
};

// Makes a window. Error: `unsupported` with the reason if there is no display or it has no OpenGL
// 4.5. The first window initialises GLFW and the end of the last one terminates it, unless the
// program has called glfwInit() before: a program with GLFW windows of its own does so, and calls
// glfwTerminate() when both kinds of windows are gone. Afterwards the hints for windows have their
// defaults.
Result<std::unique_ptr<GlWindow>> make_window(const ContextOptions& options,
                                              const WindowOptions& window);

}  // namespace atlas
