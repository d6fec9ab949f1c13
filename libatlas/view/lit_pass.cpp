// The pass that the camera sees.
#include <cmath>
#include <cstring>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/view/renderer_impl.h"

namespace atlas {
namespace {

// std140 layout of the shaders' uniform block (shaders.cpp).
struct FrameBlock {
  float view_projection[16];
  float to_map[2][16];
  float eye[4];
  float light[4];
  float ambient[4];
  float weights[4];
  float march[4];
  float specular[4];
};

void put(float (&to)[16], const Matrix4& from) {
  for (int i = 0; i < 16; ++i) to[i] = float(from[i]);
}

void put(float (&to)[4], double a, double b, double c, double d) {
  to[0] = float(a);
  to[1] = float(b);
  to[2] = float(c);
  to[3] = float(d);
}

KeyBlend blend_of(ShadowMethod method) {
  if (method == ShadowMethod::slerp) return KeyBlend::slerp_raw;
  return method == ShadowMethod::slerp_normalised ? KeyBlend::slerp_normalised : KeyBlend::linear;
}

}  // namespace

void Renderer::Impl::fill_block(const Camera& camera, const FrameLight& light,
                                const FramePlan& plan, int nearest) {
  FrameBlock b;
  std::memset(&b, 0, sizeof b);
  put(b.view_projection, view_projection(camera, double(target_width) / target_height));
  put(b.eye, camera.eye.x, camera.eye.y, camera.eye.z, 1);
  const glm::dvec3 l = glm::normalize(to_glm(light.direction));
  put(b.light, l.x, l.y, l.z, options.intensity);
  const double ambient = scene->baked_vertices || scene->baked_textures ? 0 : options.ambient;
  put(b.ambient, ambient, ambient, ambient, options.exposure);
  if (shadow) {
    const LightFit& from = shadow->fit(nearest);
    put(b.to_map[0], from.to_texture);
    put(b.to_map[1], shadow->fit(plan.to).to_texture);
    const BlendWeights w = blend_weights(blend_of(options.shadows), plan.t,
                                         angle_between(plan.from_direction, plan.to_direction));
    put(b.weights, w.from, w.to, options.normal_offset * from.texel, 1.0 / options.map_resolution);
    // The ray to the current light in the map of the key: uv per unit of depth gained.
    const Vec3d ray = transform_vector(from.to_texture, from_glm(l));
    const double rise = -ray.z;
    const bool usable = rise > 1e-3 / from.depth_range;
    put(b.march, usable ? ray.x / rise : 0, usable ? ray.y / rise : 0, 1,
        2 * from.texel / from.depth_range);
  }
  put(b.specular, options.specular, options.shininess, options.roughness, options.map_resolution);
  glNamedBufferSubData(frame_block.get(), 0, sizeof b, &b);
}

void Renderer::Impl::draw_lit(const Camera& camera, const FrameLight& light, const FramePlan& plan,
                              FrameStats& stats) {
  if (!frame_block) frame_block = make_buffer(nullptr, sizeof(FrameBlock), GL_DYNAMIC_STORAGE_BIT);
  int nearest = plan.from;
  if (options.shadows == ShadowMethod::march &&
      angle_between(plan.to_direction, light.direction) <
          angle_between(plan.from_direction, light.direction))
    nearest = plan.to;
  fill_block(camera, light, plan, nearest);

  glBindFramebuffer(GL_FRAMEBUFFER, target.get());
  glViewport(0, 0, target_width, target_height);
  glDepthMask(GL_TRUE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  const Vec3f& c = options.background;
  const float clear[4] = {features.visibility ? 1 : c.x, features.visibility ? 1 : c.y,
                          features.visibility ? 1 : c.z, 1};
  const float far = 1;
  glClearNamedFramebufferfv(target.get(), GL_COLOR, 0, clear);
  glClearNamedFramebufferfv(target.get(), GL_DEPTH, 0, &far);

  glUseProgram(program.get());
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, frame_block.get());
  if (shadow) {
    shadow->bind_compare(nearest, 1);
    if (features.shadow == ShadowSampling::two) shadow->bind_compare(plan.to, 2);
    if (features.shadow == ShadowSampling::march) shadow->bind_depth(nearest, 3);
  }
  glBindVertexArray(scene->lit.get());
  glBindSampler(0, 0);
  const auto draw = [&](std::uint32_t first, std::uint32_t count) {
    glDrawElements(GL_TRIANGLES, GLsizei(count), GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(std::uintptr_t(first) * 4));
    stats.triangles_lit += count / 3;
  };
  if (!features.textured) return draw(0, scene->triangles * 3);
  for (const ViewScene::Batch& batch : scene->batches) {
    const GLuint texture =
        batch.texture < 0 ? scene->white.get() : scene->textures[std::size_t(batch.texture)].get();
    glBindTextureUnit(0, texture);
    draw(batch.first, batch.count);
  }
}

}  // namespace atlas
