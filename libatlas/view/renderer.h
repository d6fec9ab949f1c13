// Draws a scene under a moving light with one of the shadow methods, into an image of its own.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libatlas/core/image.h"
#include "libatlas/core/status.h"
#include "libatlas/shadow/blend.h"
#include "libatlas/shadow/schedule.h"
#include "libatlas/view/camera.h"
#include "libatlas/view/shaders.h"
#include "libatlas/view/view_scene.h"

namespace atlas {

enum class ShadowMethod {
  none,
  classic,           // a map every frame (Williams 1978)
  hold,              // a map every k frames, used until the next: the honest baseline
  linear,            // visibilities of two keys blended with 1-t and t
  slerp,             // with the spherical weights as published
  slerp_normalised,  // with the spherical weights divided by their sum
  march,             // two keys' depths, searched along the ray to the current light
};

inline constexpr ShadowMethod kAllMethods[] = {
    ShadowMethod::none,  ShadowMethod::classic,          ShadowMethod::hold, ShadowMethod::linear,
    ShadowMethod::slerp, ShadowMethod::slerp_normalised, ShadowMethod::march};

const char* name_of(ShadowMethod method);

struct RenderOptions {
  int width = 640, height = 400;
  Shading shading = Shading::lambert;
  ShadowMethod shadows = ShadowMethod::march;
  bool show_visibility = false;  // grey values of the light's visibility instead of colours

  int map_resolution = 2048;
  int map_bits = 32;    // of a map's depths: 16 or 24 (integers), 32 (floats)
  int pcf = 3;          // see ShaderFeatures::pcf
  int march_steps = 4;  // march: even map samples along the ray at least, see march_samples()
  // In units of the filter's reach. The normal offset (times how far the normal leans along each of
  // the map's axes) is just what a plane needs; the slope bias (times the tangent of the angle to
  // the light, up to 8) is for curved surfaces, whose normals are not their triangles', and more of
  // it lets light through thin walls: a wall a texel thick leaks from 0.1 on.
  double slope_bias = 0.07, normal_offset = 1.0;
  bool fit_view = false;     // fit maps to the view instead of the whole scene
  double view_distance = 0;  // fit_view: how far shadows reach; 0: a quarter of the scene
  bool snap = true;
  ScheduleOptions schedule;  // interval and slicing; `blend` is set by the method

  double ambient = 0.25, intensity = 0.9;
  double baked_strength = 1;  // factor on the light that the scene brings along
  double exposure = 1;
  double specular = 0.3, shininess = 40, roughness = 0.2;  // Blinn-Phong's n, Ward's alpha
  Vec3f background{0.55f, 0.65f, 0.8f};                    // as displayed
  Vec3d up{0, 1, 0};
};

// Samples that the march takes along the ray in each key: one for each degree between the keys, so
// that blockers of one size are met however far the keys are apart; at least `least` and, unless
// that is more, at most kMostMarchSamples.
inline constexpr int kMostMarchSamples = 24;
int march_samples(int least, double key_degrees);

// The light in one frame: where it is now (towards it), and where it will be (see KeySchedule).
struct FrameLight {
  Vec3d direction{0.3, 1, 0.2};
  KeySchedule::Ahead ahead;
};

struct FrameStats {
  std::uint32_t triangles_lit = 0, triangles_shadow = 0;  // submitted in this frame
  bool refreshed = false;  // the schedule had to draw its maps at once
  double key_degrees = 0;  // between the keys sampled
  double t = 0;
};

class Renderer {
 public:
  // Needs a current OpenGL 4.5 context that outlives it. Scenes can be shared by several renderers:
  // see share().
  static Result<Renderer> make(const ViewScene& scene, const RenderOptions& options);
  // Another renderer of the same uploaded scene, with maps of its own.
  Result<Renderer> share(const RenderOptions& options) const;

  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  // Changes settings; what they need is compiled or allocated anew, and maps are drawn again where
  // they depend on them. On failure the former settings stay.
  Status set_options(const RenderOptions& options);
  const RenderOptions& options() const;

  // Draws one frame. `bad_input` with the GL error if there was one.
  Result<FrameStats> draw(const Camera& camera, const FrameLight& light);

  // Waits for the GPU.
  void finish();
  // GPU time of the last finished frame's shadow and lit passes, seconds (GL_TIME_ELAPSED); NaN
  // before the second frame.
  double shadow_seconds() const;
  double lit_seconds() const;

  // The last frame as RGB, rows bottom-up.
  Image8 read_image() const;
  // Copies the last frame to the window's own framebuffer.
  void show(int window_width, int window_height) const;

  // Whole shadow maps begun so far.
  std::int64_t shadow_passes() const;
  const Box3& bounds() const;
  // What is compiled and allocated, and why the rest is not, one line each.
  std::vector<std::string> plan() const;

  struct Impl;

 private:
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace atlas
