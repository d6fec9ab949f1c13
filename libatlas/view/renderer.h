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
  classic,           // a map in every frame (Williams 1978)
  hold,              // a map every k frames, used until the next one: the baseline
  linear,            // visibilities from two keys, blended with 1-t and t
  slerp,             // the same with the spherical weights as published
  slerp_normalised,  // the same with the spherical weights divided by their sum
  march,             // the depths of two keys, searched along the ray to the current light
};

inline constexpr ShadowMethod kAllMethods[] = {
    ShadowMethod::none,  ShadowMethod::classic,          ShadowMethod::hold, ShadowMethod::linear,
    ShadowMethod::slerp, ShadowMethod::slerp_normalised, ShadowMethod::march};

const char* name_of(ShadowMethod method);

struct RenderOptions {
  int width = 640, height = 400;  // 1..16384
  Shading shading = Shading::lambert;
  ShadowMethod shadows = ShadowMethod::march;
  bool show_visibility = false;  // grey values of the light's visibility, not colours

  int map_resolution = 2048;
  int map_bits = 32;  // of each depth in a map: 16 or 24 (integers), 32 (floats)
  int pcf = 3;        // see ShaderFeatures::pcf
  // march: the least number of even map samples along the ray, see march_samples().
  int march_steps = 4;
  // Both are in units of the filter's reach. The normal offset is multiplied by how far the normal
  // leans along each of the map's axes, which is exactly what a plane needs. The slope bias is
  // multiplied by the tangent of the angle to the light (up to 8); curved surfaces need it, since
  // their normals differ from their triangles'. A larger slope bias lets light through thin walls:
  // a wall one texel thick leaks from 0.1 on. Neither is negative.
  double slope_bias = 0.07, normal_offset = 1.0;
  bool fit_view = false;  // fits maps to the view instead of the whole scene
  // fit_view: how far from the camera shadows reach, >= 0; 0: to the far side of the sphere around
  // ViewScene::middle, with a quarter of its radius to spare.
  double view_distance = 0;
  bool snap = true;
  ScheduleOptions schedule = {};  // interval and slicing; the method sets `blend`

  double ambient = 0.25, intensity = 0.9;  // >= 0
  double baked_strength = 1;               // factor on the light baked into the scene, >= 0
  double exposure = 1;                     // factor on all light, > 0
  double specular = 0.3;                   // strength of the highlight, >= 0
  double shininess = 40, roughness = 0.2;  // Blinn-Phong's n, Ward's alpha; > 0
  Vec3f background{0.55f, 0.65f, 0.8f};    // as displayed
  Vec3d up{0, 1, 0};                       // of any length above 0
};

// Returns how many samples the march takes along the ray in each key: one for each degree between
// the keys, so that blockers of a given size are found however far apart the keys are. The result
// is at least `least`, and at most kMostMarchSamples unless `least` is larger.
inline constexpr int kMostMarchSamples = 24;
int march_samples(int least, double key_degrees);

// The light in one frame: its present direction (towards it), and where it will be (see
// KeySchedule).
struct FrameLight {
  Vec3d direction{0.3, 1, 0.2};
  KeySchedule::Ahead ahead = {};
};

struct FrameStats {
  std::uint32_t triangles_lit = 0, triangles_shadow = 0;  // submitted in this frame
  bool refreshed = false;  // the schedule had to draw its maps at once
  double key_degrees = 0;  // angle between the keys that are sampled
  double t = 0;
};

// Lengths in the scene's unit.
struct MapReach {
  double distance = 0;  // from the camera, as far as shadows reach; 0: all of the scene has them
  double texel = 0;     // of a side of a shadow map's texel; 0: there are no maps
};

class Renderer {
 public:
  // Uploads the scene. Needs a current OpenGL 4.5 context that outlives the renderer. Several
  // renderers can share a scene: see share().
  static Result<Renderer> make(const ViewScene& scene, const RenderOptions& options);
  // Returns another renderer of the same uploaded scene, with maps of its own.
  Result<Renderer> share(const RenderOptions& options) const;

  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  // Changes settings: compiles or allocates anew what they need, and draws maps again if these
  // depend on them. On failure the former settings stay.
  Status set_options(const RenderOptions& options);
  const RenderOptions& options() const;

  // Draws one frame. Errors: `bad_input` with the first GL error, or `unsupported` if memory ran
  // out or the context was lost.
  Result<FrameStats> draw(const Camera& camera, const FrameLight& light);

  // Waits until the GPU has finished.
  void finish();
  // Returns the GPU time of the shadow and lit passes of the last frame whose times have arrived,
  // in seconds (GL_TIME_ELAPSED); NaN before any has. Without shadows the former is 0.
  double shadow_seconds() const;
  double lit_seconds() const;

  // Returns the last frame as RGB, rows bottom-up.
  Image8 read_image() const;
  // Copies the last frame to the window's own framebuffer.
  void show(int window_width, int window_height) const;

  // Returns how many shadow maps have been begun so far.
  std::int64_t shadow_passes() const;
  // Returns what maps cover that are drawn for this camera and light. Errors: those of fit_light().
  Result<MapReach> map_reach(const Camera& camera, const Vec3d& direction) const;
  const Box3& bounds() const;
  // Returns what is compiled and allocated, and why the rest is not, one line each.
  std::vector<std::string> plan() const;

  struct Impl;

 private:
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace atlas
