// Internal: a ViewScene on the GPU.
#pragma once

#include <vector>

#include "libatlas/view/gl_objects.h"
#include "libatlas/view/view_scene.h"

namespace atlas {

struct GpuScene {
  GlBuffer positions, normals, colours, texcoords, illumination, indices;
  GlBuffer caster_positions, caster_indices;
  GlVertexArray lit, casters;
  std::vector<ViewScene::Cluster> clusters;
  std::vector<GlTexture> textures;  // one a scene texture
  GlTexture blank;  // for triangles without one: white, or black where textures hold light
  std::uint32_t triangles = 0;
  Box3 bounds;   // in the scene's own coordinates, as the clusters' balls
  Vec3d origin;  // the box's middle, which uploaded positions are relative to: floats are finest
                 // near zero
  bool textured = false, baked_vertices = false, baked_textures = false;
  double light_scale = 1;
};

// Needs a current context. `unsupported` if a texture is larger than the driver takes or memory
// runs out.
Result<GpuScene> upload(const ViewScene& scene);

}  // namespace atlas
