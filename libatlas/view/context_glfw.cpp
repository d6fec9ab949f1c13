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

// GLFW reports errors only through a callback. The last text is kept for the Status.
std::string& last_error() {
  static std::string text;
  return text;
}

void on_error(int, const char* text) {
  last_error() = text;
}

// Xlib's Display* is a void* here. GLFW has one connection for all windows of the process. The
// program may have others, whose errors are left to the program.
using Handler = int (*)(void*);
struct DisplayWatch {
  void* connection = nullptr;  // GLFW's connection
  Handler before = nullptr;    // the handler that the program had set
  std::atomic<bool> lost = false;
};

DisplayWatch& watch() {
  static DisplayWatch state;
  return state;
}

int on_display_lost(void* display) {
  DisplayWatch& state = watch();
  if (display != state.connection) return state.before ? state.before(display) : 0;
  state.lost = true;
  return 0;
}
void keep_running(void*, void*) {}

// When the X server goes, Xlib ends the process with a message of its own unless both handlers are
// set (the second exists since libX11 1.7). The functions are looked up in the libraries that GLFW
// has loaded, since there may be no X11 at all; GLFW 3.4 keeps libX11 to itself.
void watch_display() {
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
  watch().connection = connection;
  const Handler before = reinterpret_cast<Handler (*)(Handler)>(set)(on_display_lost);
  if (before != on_display_lost) watch().before = before;
  reinterpret_cast<void (*)(void*, ExitHandler, void*)>(set_exit)(connection, keep_running,
                                                                  nullptr);
  // A write to a lost connection must fail, and not end the process before the handlers are called.
  struct sigaction present {};
  if (sigaction(SIGPIPE, nullptr, &present) == 0 && present.sa_handler == SIG_DFL) {
    std::signal(SIGPIPE, SIG_IGN);
  }
}

// Initialises GLFW with the first window and terminates it with the last one, since glfwTerminate()
// closes all windows. A program that has initialised GLFW by itself terminates it, too.
class GlfwUse {
 public:
  GlfwUse() = default;
  ~GlfwUse() {
    if (!begun_ || --users() > 0 || !ours() || watch().lost) return;
    glfwTerminate();
  }
  GlfwUse(const GlfwUse&) = delete;
  GlfwUse& operator=(const GlfwUse&) = delete;

  bool begin() {
    if (users() == 0) {
      glfwGetTime();  // sets the error if GLFW is not initialised
      ours() = glfwGetError(nullptr) == GLFW_NOT_INITIALIZED;
    }
    begun_ = glfwInit() == GLFW_TRUE;
    users() += begun_;
    return begun_;
  }

 private:
  static int& users() {
    static int count = 0;
    return count;
  }
  static bool& ours() {
    static bool begun_here = false;
    return begun_here;
  }
  bool begun_ = false;
};

// Keeps the text of errors while it exists, then restores the program's callback.
class GlfwCall {
 public:
  GlfwCall() : before_(glfwSetErrorCallback(on_error)) {}
  ~GlfwCall() { glfwSetErrorCallback(before_); }
  GlfwCall(const GlfwCall&) = delete;
  GlfwCall& operator=(const GlfwCall&) = delete;

 private:
  GLFWerrorfun before_;
};

class GlfwWindow : public GlWindow {
 public:
  ~GlfwWindow() override {
    // A lost connection accepts no requests, not even to destroy its window.
    if (window_ && !lost()) glfwDestroyWindow(window_);
  }
  GLFWwindow* handle() override { return window_; }
  bool lost() const override { return watch().lost; }

  Status open(const ContextOptions& options, const WindowOptions& wanted) {
    if (!use_.begin())
      return {ErrorCode::unsupported,
              fmt::format("no window: {} (try --headless --screenshot FILE.png)", last_error())};
    watch_display();
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, options.debug);
    // GLFW ignores this hint if the driver does not support it.
    glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);
    glfwWindowHint(GLFW_VISIBLE, wanted.visible);
    window_ = glfwCreateWindow(wanted.width, wanted.height, wanted.title.c_str(), nullptr, nullptr);
    glfwDefaultWindowHints();  // the next window may be the program's own
    if (!window_)
      return {ErrorCode::unsupported,
              fmt::format("no OpenGL 4.5 window: {} (try --headless --screenshot FILE.png)",
                          last_error())};
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(wanted.vsync ? 1 : 0);
    return initialise(options.debug);
  }

 private:
  GlfwUse use_;  // destroyed after the window
  GLFWwindow* window_ = nullptr;
};

}  // namespace

Result<std::unique_ptr<GlWindow>> make_window(const ContextOptions& options,
                                              const WindowOptions& window) {
  if (watch().lost) return Status{ErrorCode::unsupported, "no window: the display server has gone"};
  const GlfwCall call;
  auto made = std::make_unique<GlfwWindow>();
  if (Status s = made->open(options, window); !s.ok()) return s;
  return std::unique_ptr<GlWindow>(std::move(made));
}

}  // namespace atlas
