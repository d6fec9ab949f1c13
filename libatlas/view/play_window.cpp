// Runs the player in a window.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <utility>

#include "libatlas/core/clock.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/shadow/light_clock.h"
#include "libatlas/view/bench.h"
#include "libatlas/view/hand_light.h"
#include "libatlas/view/picture_file.h"
#include "libatlas/view/play.h"

namespace atlas {
namespace {

class Gui {
 public:
  explicit Gui(GLFWwindow* window) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;  // leaves no file behind
    ImGui_ImplGlfw_InitForOpenGL(window, true);
    ImGui_ImplOpenGL3_Init("#version 450 core");
  }
  ~Gui() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
  }
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;
  // Returns false if the display has gone: the sizes that GLFW asked it for are then arbitrary.
  bool begin(const GlWindow& window) {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    if (window.lost()) return false;
    ImGui::NewFrame();
    return true;
  }
  void end() {
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  }
};

constexpr const char* kHelp =
    "drag: look around      W A S D: walk\n"
    "E Q: up, down          shift: faster\n"
    "1..7: shadow method    V: visibility\n"
    "space: light rests     R: first place\n"
    "H: this panel          F12: screenshot\n"
    "esc: end";

class Player {
 public:
  Player(GlWindow& window, Renderer& renderer, const PlayOptions& options)
      : window_(window),
        renderer_(renderer),
        options_(options),
        wanted_(renderer.options()),
        camera_(options.camera),
        gui_(window.handle()),
        clock_({options.max_step}) {
    const Box3& b = renderer.bounds();
    // Crosses the whole scene in eight seconds: a hall at walking pace, a city in flight.
    stride_range_ = glm::length(to_glm(b.high) - to_glm(b.low));
    stride_ = stride_range_ / 8;
    speed_ = float(options.degrees_per_second);
    recording_ = !options.record.empty();
  }

  Result<PlaySummary> run(const Context& context) {
    double last = wall_seconds();
    while (!glfwWindowShouldClose(window_.handle())) {
      if (context.cancelled()) return Status::cancelled();
      glfwPollEvents();
      const double now = wall_seconds(), elapsed = now - last;
      last = now;
      Status s = frame(elapsed);
      if (window_.lost())
        return Status{ErrorCode::unsupported,
                      "the display server has gone, the window is lost (start it again, or use "
                      "--headless)"};
      if (!s.ok()) return s;
      if (options_.close_after > 0 && summary_.frames >= options_.close_after) break;
    }
    summary_.shadow_passes = renderer_.shadow_passes();
    summary_.gl_errors = window_.debug_errors();
    summary_.median_seconds = spread_of(all_times_).p50;
    return summary_;
  }

 private:
  Status frame(double elapsed) {
    if (!gui_.begin(window_)) return {};
    steer(elapsed);
    note_time(elapsed);
    if (panel_shown_) panel();
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_.handle(), &width, &height);
    if (width < 1 || height < 1) {  // iconified
      ImGui::EndFrame();
      glfwWaitEventsTimeout(0.1);
      return {};
    }
    wanted_.width = width;
    wanted_.height = height;
    // If a setting is not possible, the message says so and the former settings stay.
    if (Status s = renderer_.set_options(wanted_); !s.ok()) {
      message_ = s.message();
      wanted_ = renderer_.options();
    }
    if (Status s = draw(elapsed); !s.ok()) return s;
    renderer_.show(width, height);
    if (Status s = save(); !s.ok()) message_ = s.message();
    gui_.end();
    if (options_.close_after > 0 && summary_.frames + 1 == options_.close_after &&
        !options_.screenshot.empty())
      if (Status s = write_picture(options_.screenshot, window_image(width, height)); !s.ok())
        return s;
    glfwSwapBuffers(window_.handle());
    ++summary_.frames;
    return {};
  }

  Status draw(double elapsed) {
    clock_.advance(elapsed, paused_ || by_hand_ ? 0 : speed_);
    FrameLight light;
    if (by_hand_) {
      light.direction = hand_direction(hand_light_, wanted_.up);
    } else {
      light.direction = options_.light.direction(clock_.travelled());
      light.ahead = [this](int n) { return options_.light.direction(clock_.ahead(n)); };
    }
    Result<FrameStats> stats = renderer_.draw(camera_, light);
    if (Status s = window_.check_alive(); !s.ok()) return s;
    if (!stats.ok()) return stats.status();
    stats_ = *stats;
    return {};
  }

  void steer(double elapsed) {
    const ImGuiIO& io = ImGui::GetIO();
    GLFWwindow* w = window_.handle();
    Vec3d step;
    double yaw = 0, pitch = 0;
    if (!io.WantCaptureMouse && (io.MouseDown[0] || io.MouseDown[1])) {
      yaw = -0.2 * io.MouseDelta.x;
      pitch = -0.2 * io.MouseDelta.y;
    }
    if (!io.WantCaptureKeyboard) {
      const auto held = [&](int key) { return glfwGetKey(w, key) == GLFW_PRESS ? 1.0 : 0.0; };
      const double pace = stride_ * elapsed * (held(GLFW_KEY_LEFT_SHIFT) > 0 ? 4 : 1);
      step = {pace * (held(GLFW_KEY_W) - held(GLFW_KEY_S)),
              pace * (held(GLFW_KEY_D) - held(GLFW_KEY_A)),
              pace * (held(GLFW_KEY_E) - held(GLFW_KEY_Q))};
      keys();
    }
    fly(camera_, step, yaw, pitch);
    fit_planes(camera_, renderer_.bounds());
  }

  // Handles the keys that act once per press.
  void keys() {
    if (pressed(GLFW_KEY_F12)) shoot_ = true;
    if (pressed(GLFW_KEY_H)) panel_shown_ = !panel_shown_;
    if (pressed(GLFW_KEY_SPACE)) paused_ = !paused_;
    if (pressed(GLFW_KEY_V)) wanted_.show_visibility = !wanted_.show_visibility;
    if (pressed(GLFW_KEY_R)) camera_ = options_.camera;
    if (pressed(GLFW_KEY_ESCAPE)) glfwSetWindowShouldClose(window_.handle(), GLFW_TRUE);
    for (int i = 0; i < int(std::size(kAllMethods)); ++i)
      if (pressed(GLFW_KEY_1 + i)) wanted_.shadows = kAllMethods[i];
  }

  bool pressed(int key) {
    const bool down = glfwGetKey(window_.handle(), key) == GLFW_PRESS;
    return std::exchange(was_down_[std::size_t(key)], down) != down && down;
  }

  // Returns what the window shows, including its panel.
  static Image8 window_image(int width, int height) {
    Image8 image(width, height, 3);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    glReadBuffer(GL_BACK);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, image.texels.data());
    return image;
  }

  void note_time(double elapsed) {
    times_[at_++ % times_.size()] = float(elapsed * 1e3);
    all_times_.push_back(elapsed);
    if (all_times_.size() > 100000)
      all_times_.erase(all_times_.begin(), all_times_.begin() + 50000);
  }

  void panel() {
    ImGui::SetNextWindowPos({8, 8}, ImGuiCond_FirstUseEver);
    ImGui::Begin("atlas-play", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
    float worst = 0;
    for (float t : times_) worst = std::max(worst, t);
    const std::string label =
        fmt::format("{:.1f} ms, worst {:.1f}", times_[(at_ - 1) % times_.size()], worst);
    ImGui::PlotLines("##times", times_.data(), int(times_.size()), int(at_ % times_.size()),
                     label.c_str(), 0, worst * 1.1f, {280, 70});
    ImGui::Text("shadow %.2f ms, lit %.2f ms, %u + %u triangles", renderer_.shadow_seconds() * 1e3,
                renderer_.lit_seconds() * 1e3, stats_.triangles_shadow, stats_.triangles_lit);
    if (ImGui::CollapsingHeader("keys", ImGuiTreeNodeFlags_DefaultOpen))
      ImGui::TextUnformatted(kHelp);
    shadow_panel();
    light_panel();
    slider("walking speed, units a second", stride_, stride_range_ / 100, stride_range_);
    if (ImGui::Button("screenshot (F12)")) shoot_ = true;
    ImGui::SameLine();
    ImGui::Checkbox("record", &recording_);
    for (const std::string& line : renderer_.plan()) ImGui::TextDisabled("%s", line.c_str());
    if (!message_.empty()) ImGui::TextWrapped("%s", message_.c_str());
    ImGui::End();
  }

  void shadow_panel() {
    int method = int(wanted_.shadows), shading = int(wanted_.shading);
    ImGui::Combo("shadows", &method,
                 "none\0classic\0hold\0linear\0slerp\0slerp normalised\0march\0");
    ImGui::Combo("shading", &shading, "unlit\0lambert\0blinn-phong\0ward\0");
    wanted_.shadows = ShadowMethod(method);
    wanted_.shading = Shading(shading);
    ImGui::SliderInt("key every k frames", &wanted_.schedule.interval_frames, 1, 64);
    ImGui::Checkbox("spread over frames", &wanted_.schedule.sliced);
    ImGui::SameLine();
    ImGui::Checkbox("show visibility", &wanted_.show_visibility);
    constexpr int kTaps[] = {0, 1, 3, 5};
    int filter = wanted_.pcf == 5 ? 3 : wanted_.pcf == 3 ? 2 : wanted_.pcf;
    ImGui::Combo("filter", &filter, "nearest\0bilinear\0003x3\0005x5\0");
    wanted_.pcf = kTaps[filter];
    slider("slope bias", wanted_.slope_bias, 0, 8);
    slider("normal offset", wanted_.normal_offset, 0, 4);
  }

  void light_panel() {
    ImGui::Checkbox("pause", &paused_);
    ImGui::SameLine();
    if (ImGui::Checkbox("by hand", &by_hand_) && by_hand_)
      hand_light_ = hand_light_of(options_.light.direction(clock_.travelled()), wanted_.up);
    ImGui::SliderFloat("degrees a second", &speed_, 0, 90);
    if (clock_.slowed())
      ImGui::TextDisabled("slowed to %.1f degrees a frame (--max-step)", options_.max_step);
    if (by_hand_) {
      ImGui::SliderFloat("azimuth", &hand_light_.azimuth, 0, 360);
      ImGui::SliderFloat("elevation", &hand_light_.elevation, -kSteepestHandLight,
                         kSteepestHandLight);
    }
    slider("sun", wanted_.intensity, 0, 4);
    slider("ambient", wanted_.ambient, 0, 1);
    slider("baked light", wanted_.baked_strength, 0, 4);
    slider("exposure", wanted_.exposure, 0.1, 8);
    slider("specular", wanted_.specular, 0, 1);
    if (wanted_.shading == Shading::blinn_phong) slider("shininess", wanted_.shininess, 1, 200);
    if (wanted_.shading == Shading::ward) slider("roughness", wanted_.roughness, 0.02, 1);
  }

  static void slider(const char* name, double& value, double low, double high) {
    float v = float(value);
    if (ImGui::SliderFloat(name, &v, float(low), float(high))) value = v;
  }

  Status save() {
    namespace fs = std::filesystem;
    if (recording_) {
      const fs::path file = recorded_frame(options_, summary_.recorded);
      std::error_code error;
      fs::create_directories(file.parent_path(), error);
      if (error) return {ErrorCode::io, file.parent_path().string() + ": " + error.message()};
      const Status s = write_picture(file, renderer_.read_image());
      if (!s.ok()) return s;
      ++summary_.recorded;
    }
    if (!std::exchange(shoot_, false)) return {};
    const fs::path file = screenshot_file(options_);
    message_ = "wrote " + file.string();
    return write_picture(file, renderer_.read_image());
  }

  GlWindow& window_;
  Renderer& renderer_;
  const PlayOptions& options_;
  RenderOptions wanted_;
  Camera camera_;
  Gui gui_;
  FrameStats stats_;
  PlaySummary summary_;
  std::array<bool, GLFW_KEY_LAST + 1> was_down_{};
  std::array<float, 240> times_{};
  std::vector<double> all_times_;
  std::size_t at_ = 0;
  LightClock clock_;
  double stride_ = 1, stride_range_ = 1;
  HandLight hand_light_;
  float speed_ = 15;
  bool paused_ = false, by_hand_ = false, recording_ = false, shoot_ = false, panel_shown_ = true;
  std::string message_;
};

}  // namespace

Result<PlaySummary> play_in_window(GlWindow& window, Renderer& renderer, const PlayOptions& options,
                                   const Context& context) {
  Player player(window, renderer, options);
  return player.run(context);
}

}  // namespace atlas
