// Internal: a ViewScene on the GPU.
#pragma once

#include <array>
#include <vector>

#include "libatlas/view/gl_objects.h"
#include "libatlas/view/view_scene.h"

namespace atlas {

struct GpuScene {
  GlBuffer positions, normals, colours, texcoords, illumination, emission, light_texcoords, indices;
  GlBuffer caster_positions, caster_indices;
  GlVertexArray lit, casters;
  std::vector<ViewScene::Cluster> clusters;
  std::vector<GlTexture> textures;  // one per scene texture
  GlTexture blank;                  // for triangles without a texture: white
  // The samplers of textures, by wrap_u, then by wrap_v, and that of atlas pages.
  std::array<std::array<GlSampler, 3>, 3> samplers;
  GlSampler page_sampler;
  // Binds the look's texture and sampler to unit 0. Only for textured scenes.
  void bind_texture(const ViewScene::Look& look) const;
  // The lightmap's pages, times light_scale. Those that no cluster shows are none.
  std::vector<GlTexture> light_pages;
  GlTexture dark;  // for clusters without a page: black
  // Binds the look's page to unit 4. Only for scenes with a lightmap.
  void bind_light(const ViewScene::Look& look) const;
  std::uint32_t casters_alone = 0;  // triangles of `casters`
  // Clusters with holes cast shadows, too, in this order after those; and how many triangles.
  std::vector<ViewScene::Cluster> with_holes;
  std::uint32_t holed_triangles = 0;
  Box3 bounds, middle;  // in the scene's own coordinates, like the clusters' spheres
  // The box's centre, to which uploaded positions are relative, since floats are finest near zero.
  Vec3d origin;
  bool textured = false, baked_vertices = false, lightmap = false, emits = false;
  Unlit unlit = Unlit::none;
  double light_scale = 1;
};

// Uploads a scene. Needs a current context. Error: `unsupported` if a texture is larger than the
// driver allows or memory runs out.
Result<GpuScene> upload(const ViewScene& scene);

}  // namespace atlas
