#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <dlfcn.h>
#include <fmt/format.h>

#include <atomic>
#include <csignal>

#include <memory>

#include "libatlas/view/context.h"

namespace atlas {
namespace {

// GLFW reports through a callback only; the last text is kept for the Status.
std::string& last_error() {
  static std::string text;
  return text;
}

void on_error(int, const char* text) {
  last_error() = text;
}

std::atomic<bool>& display_lost() {
  static std::atomic<bool> lost = false;
  return lost;
}

int on_display_lost(void*) {
  display_lost() = true;
  return 0;
}
void keep_running(void*, void*) {}

// Xlib ends the process with a message of its own when the X server goes, unless both handlers are
// set (the second exists since libX11 1.7). The functions are looked up in what GLFW has loaded
// (3.4 keeps the library to itself): there may be no X11 at all. `void*` stands for Xlib's
// Display*.
void watch_display() {
  using Handler = int (*)(void*);
  using ExitHandler = void (*)(void*, void*);
  void* const x11 = dlopen("libX11.so.6", RTLD_NOW | RTLD_NOLOAD);
  const auto find = [&](const char* name) {
    void* const own = x11 ? dlsym(x11, name) : nullptr;
    return own ? own : dlsym(RTLD_DEFAULT, name);
  };
  void* const display = find("glfwGetX11Display");
  void* const set = find("XSetIOErrorHandler");
  void* const set_exit = find("XSetIOErrorExitHandler");
  if (!display || !set || !set_exit) return;
  void* const connection = reinterpret_cast<void* (*)()>(display)();
  if (!connection) return;
  reinterpret_cast<Handler (*)(Handler)>(set)(on_display_lost);
  reinterpret_cast<void (*)(void*, ExitHandler, void*)>(set_exit)(connection, keep_running,
                                                                  nullptr);
  // A write to a connection that is gone is to fail, not to end the process before they are called.
  struct sigaction present {};
  if (sigaction(SIGPIPE, nullptr, &present) == 0 && present.sa_handler == SIG_DFL) {
    std::signal(SIGPIPE, SIG_IGN);
  }
}

class GlfwWindow : public GlWindow {
 public:
  ~GlfwWindow() override {
    if (lost()) return;  // a dead connection takes no requests, not even to destroy its window
    if (window_) glfwDestroyWindow(window_);
    glfwTerminate();
  }
  GLFWwindow* handle() override { return window_; }
  bool lost() const override { return display_lost(); }

  Status open(const ContextOptions& options, const WindowOptions& wanted) {
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, options.debug);
    // Left out by GLFW where the driver does not have it.
    glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);
    glfwWindowHint(GLFW_VISIBLE, wanted.visible);
    window_ = glfwCreateWindow(wanted.width, wanted.height, wanted.title.c_str(), nullptr, nullptr);
    if (!window_)
      return {ErrorCode::unsupported,
              fmt::format("no OpenGL 4.5 window: {} (try --headless)", last_error())};
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(wanted.vsync ? 1 : 0);
    return initialise(options.debug);
  }

 private:
  GLFWwindow* window_ = nullptr;
};

}  // namespace

Result<std::unique_ptr<GlWindow>> make_window(const ContextOptions& options,
                                              const WindowOptions& window) {
  glfwSetErrorCallback(on_error);
  if (!glfwInit())
    return Status{ErrorCode::unsupported,
                  fmt::format("no window: {} (try --headless)", last_error())};
  watch_display();
  auto made = std::make_unique<GlfwWindow>();
  if (Status s = made->open(options, window); !s.ok()) return s;
  return std::unique_ptr<GlWindow>(std::move(made));
}

}  // namespace atlas
