// Internal: the shadow maps of one light, into each of which any slice of the casters can be drawn.
#pragma once

#include <vector>

#include "libatlas/shadow/fit.h"
#include "libatlas/shadow/schedule.h"
#include "libatlas/view/gpu_scene.h"

namespace atlas {

class ShadowPass {
 public:
  // Makes `maps` square depth textures of `resolution` texels a side and `bits` (16, 24, 32) per
  // texel. `holes`: whether casters have holes.
  static Result<ShadowPass> make(int resolution, int maps, int bits, bool holes);

  // Draws the triangles of `work` into its map. If work.begin is 0, first clears the map and stores
  // `fit`. Returns the number of triangles submitted.
  std::uint32_t draw(const GpuScene& scene, const MapWork& work, const LightFit& fit);

  const LightFit& fit(int slot) const { return maps_[std::size_t(slot)].fit; }
  // Binds all maps, one layer per slot, for depth comparison (bilinear; lit outside the map), or
  // for reading their depths (nearest; 1 outside the map).
  void bind_compare(int unit) const;
  void bind_depths(int unit) const;
  int resolution() const { return resolution_; }
  int bits() const { return bits_; }

 private:
  struct Map {
    GlFramebuffer frame;
    LightFit fit;
  };
  GlTexture layers_;
  std::vector<Map> maps_;
  GlSampler compare_, plain_;
  GlProgram program_, holed_;
  int resolution_ = 0, bits_ = 32;
};

}  // namespace atlas
