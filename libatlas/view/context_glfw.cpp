#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

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

class GlfwWindow : public GlWindow {
 public:
  ~GlfwWindow() override {
    if (window_) glfwDestroyWindow(window_);
    glfwTerminate();
  }
  GLFWwindow* handle() override { return window_; }

  Status open(const ContextOptions& options, const WindowOptions& wanted) {
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, options.debug);
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
  auto made = std::make_unique<GlfwWindow>();
  if (Status s = made->open(options, window); !s.ok()) return s;
  return std::unique_ptr<GlWindow>(std::move(made));
}

}  // namespace atlas
