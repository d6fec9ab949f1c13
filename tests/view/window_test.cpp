// Tests windows beside those of the program that uses the library.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "libatlas/view/context.h"
#include "tests/support/xvfb.h"

namespace atlas {
namespace {

class Window : public testing::Test {
 protected:
  void SetUp() override {
    if (!server_.runs()) GTEST_SKIP() << "Xvfb is not installed";
    ::setenv("DISPLAY", (":" + server_.display()).c_str(), 1);
    ::unsetenv("WAYLAND_DISPLAY");
    const auto window = make();
    if (!window) GTEST_SKIP() << "no OpenGL 4.5 in windows here";
  }
  static std::unique_ptr<GlWindow> make() {
    auto made = make_window({}, {.width = 64, .height = 48, .visible = false});
    return made.ok() ? std::move(made.value()) : nullptr;
  }
  // Returns whether GLFW is initialised, which every window needs.
  static bool glfw_runs() {
    glfwGetError(nullptr);
    glfwGetTime();
    return glfwGetError(nullptr) == GLFW_NO_ERROR;
  }

  test::Xvfb server_;
};

TEST_F(Window, ThatClosesLeavesTheNextOneOpen) {
  EXPECT_FALSE(glfw_runs());
  auto first = make(), second = make();
  ASSERT_TRUE(first && second);
  first.reset();
  ASSERT_TRUE(glfw_runs());
  int width = 0, height = 0;
  glfwGetWindowSize(second->handle(), &width, &height);
  EXPECT_EQ(width, 64);
  second.reset();
  EXPECT_FALSE(glfw_runs());
}

int told = 0;
void tell(int, const char*) {
  ++told;
}

TEST_F(Window, LeavesTheProgramsOwnOpen) {
  glfwSetErrorCallback(tell);
  ASSERT_TRUE(glfwInit());
  glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
  GLFWwindow* const own = glfwCreateWindow(32, 24, "own", nullptr, nullptr);
  ASSERT_NE(own, nullptr);
  auto window = make();
  ASSERT_TRUE(window);
  window.reset();
  ASSERT_TRUE(glfw_runs());
  int width = 0, height = 0;
  glfwGetWindowSize(own, &width, &height);
  EXPECT_EQ(width, 32);
  told = 0;
  glfwWindowHint(-1, 0);  // an error, which again goes to the program
  EXPECT_EQ(told, 1);
  glfwTerminate();
  glfwSetErrorCallback(nullptr);
}

}  // namespace
}  // namespace atlas
