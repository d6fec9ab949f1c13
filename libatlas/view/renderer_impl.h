// Internal: the renderer's state, shared by renderer.cpp, map_reach.cpp and lit_pass.cpp.
#pragma once

#include <compare>
#include <memory>
#include <optional>

#include "libatlas/view/gpu_scene.h"
#include "libatlas/view/renderer.h"
#include "libatlas/view/shadow_pass.h"
#include "libatlas/view/timers.h"

namespace atlas {

struct Renderer::Impl {
  std::shared_ptr<const GpuScene> scene;
  RenderOptions options;
  ShaderFeatures features;
  // holed: for clusters with holes, none without them; lighting: none if the scene is unlit
  GlProgram program, holed, lighting;
  GlBuffer frame_block;
  GlFramebuffer target;
  GlRenderbuffer colour;
  GlTexture depth;
  // Targets of the first pass of lit scenes. The depth belongs to them then.
  GlFramebuffer surface_target;
  GlTexture surfaces;
  bool software = false;      // the context draws on the CPU
  GlRenderbuffer depth_copy;  // lit scenes on the CPU: what the second pass tests
  GlVertexArray no_vertices;
  int target_width = 0, target_height = 0;
  double subpixel = 0;  // the driver rounds corners of triangles to multiples of it (pixels)
  std::optional<ShadowPass> shadow;
  int shadow_maps = 0;
  std::optional<KeySchedule> schedule;
  std::optional<PassTimer> shadow_timer, lit_timer;
  std::int64_t earlier_passes = 0;  // of schedules that set_options has replaced
  LightFit view_fit;                // fit_view: what the newest key covers
  bool view_fit_valid = false;
  // Slots of the last frame's keys, which were fitted up to three intervals ago.
  int sampled[2] = {0, 0};

  // A cluster to draw. Clusters are sorted by look, then from near to far.
  struct Visible {
    ViewScene::Look look;
    float distance;
    std::uint32_t cluster;
    auto operator<=>(const Visible&) const = default;
  };
  std::vector<Visible> order;  // scratch memory of a frame, like the next two
  std::vector<GLsizei> counts;
  std::vector<const void*> offsets;

  Status apply(const RenderOptions& wanted);
  Status allocate_target(int width, int height, bool lit);
  Status compile(const ShaderFeatures& wanted);
  Result<FrameStats> draw(const Camera& camera, const FrameLight& light);
  Status draw_shadow_maps(const Camera& camera, const FramePlan& plan, FrameStats& stats);
  Result<LightFit> fit(const Camera& camera, const Vec3d& direction) const;
  // Returns how far from the camera shadows reach with fit_view, see RenderOptions::view_distance.
  double reach(const Camera& camera) const;
  bool view_left_the_keys(const Camera& camera) const;
  void draw_lit(const Camera& camera, const FrameLight& light, const FramePlan& plan,
                FrameStats& stats);
  void draw_surfaces(const Camera& camera, FrameStats& stats);
  void draw_lighting();
  void draw_clusters(const Camera& camera, FrameStats& stats);
  void fill_block(const Camera& camera, const FrameLight& light, const FramePlan& plan,
                  int nearest);
};

// Returns the features that a scene and its settings need compiled.
ShaderFeatures needed_features(const GpuScene& scene, const RenderOptions& options);
ScheduleOptions schedule_for(const RenderOptions& options);
// Returns how many depth textures a method holds.
int maps_of(ShadowMethod method);

}  // namespace atlas
