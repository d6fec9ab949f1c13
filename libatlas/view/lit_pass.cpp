// Draws the pass that the camera sees.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/trigonometric.hpp>
#include <glm/vec4.hpp>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/view/renderer_impl.h"

namespace atlas {
namespace {

// The planes of a view volume with inward normals, without the far plane.
struct Frustum {
  std::array<glm::dvec4, 5> planes;
  bool touches(const glm::vec3& centre, double radius) const {
    for (const glm::dvec4& p : planes)
      if (glm::dot(glm::dvec3(p), glm::dvec3(centre)) + p.w < -radius) return false;
    return true;
  }
};

// Returns planes that are sums and differences of the matrix's rows (Gribb and Hartmann 2001).
Frustum frustum_of(const Camera& camera, double aspect) {
  const Matrix4 m = view_projection(camera, aspect);
  const auto row = [&](int r) { return glm::dvec4(m[r], m[4 + r], m[8 + r], m[12 + r]); };
  Frustum f{{row(3) + row(0), row(3) - row(0), row(3) + row(1), row(3) - row(1), row(3) + row(2)}};
  for (glm::dvec4& p : f.planes) p /= glm::length(glm::dvec3(p));
  return f;
}

// Must have the std140 layout of the shaders' uniform block (shaders.cpp).
struct FrameBlock {
  float view_projection[16];
  float to_map[2][16];
  float eye[4];
  float light[4];
  float ambient[4];
  float weights[4];
  float ray[2][4];
  float behind[4];
  float march[4];
  float corner[4];
  float inverse[4];
  float specular[4];
  float first_ray[4], ray_x[4], ray_y[4];
  float map_x[2][4], map_y[2][4];
  float background[4];
};

void put(float (&to)[16], const Matrix4& from) {
  for (int i = 0; i < 16; ++i) to[i] = float(from[i]);
}

void put(float (&to)[4], const glm::dvec4& from) {
  for (int i = 0; i < 4; ++i) to[i] = float(from[i]);
}

KeyBlend blend_of(ShadowMethod method) {
  if (method == ShadowMethod::slerp) return KeyBlend::slerp_raw;
  return method == ShadowMethod::slerp_normalised ? KeyBlend::slerp_normalised : KeyBlend::linear;
}

// How many texels behind a point the march looks for the blocker of an edge that the filter
// touches: the reach of a 3x3 filter.
constexpr double kBehindTexels = 1.5;

// If the light's rays leave the key's by fewer texels than this over the whole depth of the map,
// the light counts as standing where the key does.
constexpr double kExactTexels = 0.05;

// Returns the largest amount by which rounding can put a point behind its own depth in a map of
// `bits`, in depths: a step of the map, plus some units in the last place of floats, with which
// both passes compute. The point's error grows with its distance from the eye, which is `far` at
// most.
double rounding_of_depths(int bits, double far) {
  return (bits < 32 ? std::exp2(-bits) : 0) + (1 + far) * 0x1p-21;
}

// Returns the width of a pixel plus its height, at a view depth of 1.
double pixel_size(const FrameBlock& b) {
  const auto length = [](const float* v) { return glm::length(glm::dvec3(v[0], v[1], v[2])); };
  return length(b.ray_x) + length(b.ray_y);
}

// A key's map, and the layer that holds it.
struct KeyMap {
  const LightFit& fit;
  int layer;
};

// Stores the ray to the current light in the map of key 0 or 1.
void put_ray(FrameBlock& b, int key, const KeyMap& map, const glm::dvec3& l) {
  const LightFit& fit = map.fit;
  const Vec3d ray = transform_vector(fit.to_texture, from_glm(l));
  glm::dvec2 shift(0);
  double rise = -ray.z;
  // If the light is more than 89.9 degrees off the key's own ray, the map is sampled where the ray
  // starts.
  if (rise * fit.depth_range > 1e-3)
    shift = {ray.x / rise, ray.y / rise};
  else
    rise = 1 / fit.depth_range;
  put(b.ray[key], {shift, rise, map.layer});
  double texels = glm::length(shift) / b.weights[3];
  // The light stands at this key. What rounding leaves of the shift is no direction to search
  // along.
  if (texels < kExactTexels) {
    texels = 0;
    put(b.ray[key], {0, 0, rise, map.layer});
  }
  const glm::dvec2 back = texels > 0 ? shift * (kBehindTexels / texels) : glm::dvec2(0);
  b.behind[2 * key] = float(back.x);
  b.behind[2 * key + 1] = float(back.y);
  b.march[key] = float(texels);
}

void put_axes(FrameBlock& b, int key, const MapAxes& axes) {
  put(b.map_x[key], {to_glm(axes.x), 0});
  put(b.map_y[key], {to_glm(axes.y), 0});
}

// Stores where rays to the light leave the scene's box.
void put_box(FrameBlock& b, const glm::dvec3& l, const Box3& box, const Vec3d& origin) {
  const glm::dvec3 low = to_glm(box.low) - to_glm(origin);
  const glm::dvec3 high = to_glm(box.high) - to_glm(origin);
  for (int i = 0; i < 3; ++i) {
    b.corner[i] = float(l[i] > 0 ? high[i] : low[i]);
    b.inverse[i] = float(1 / l[i]);
    if (std::abs(l[i]) > 1e-6) continue;
    b.corner[i] = 1e30f;  // along this axis they never leave it
    b.inverse[i] = 1;
  }
}

// Changes the view's projection to a depth of 1 at the near plane and 0 at the far plane, since
// floats are dense where perspective is not.
Matrix4 reversed_depth(Matrix4 m) {
  for (int c = 0; c < 4; ++c) m[4 * c + 2] = 0.5 * (m[4 * c + 3] - m[4 * c + 2]);
  return m;
}

Camera relative_to(Camera camera, const Vec3d& origin) {
  camera.eye = from_glm(to_glm(camera.eye) - to_glm(origin));
  camera.target = from_glm(to_glm(camera.target) - to_glm(origin));
  return camera;
}

// Stores what the second pass needs to compute a pixel's point from its depth.
void put_rays(FrameBlock& b, const Camera& camera, int width, int height) {
  const double aspect = double(width) / height, n = camera.near_plane, f = camera.far_plane;
  const std::array<Vec3d, 8> corners = view_corners(camera, aspect, n);
  const glm::dvec3 first = (to_glm(corners[0]) - to_glm(camera.eye)) / n;
  const glm::dvec3 x = (to_glm(corners[1]) - to_glm(corners[0])) / (n * width);
  const glm::dvec3 y = (to_glm(corners[2]) - to_glm(corners[0])) / (n * height);
  put(b.first_ray, {first, 1 / f});
  put(b.ray_x, {x, 1 / n - 1 / f});
  put(b.ray_y, {y, 0});
}

glm::dvec4 background_of(const RenderOptions& options, const ShaderFeatures& features) {
  return {features.visibility ? glm::dvec3(1) : glm::dvec3(to_glm(options.background)), 1};
}

}  // namespace

void Renderer::Impl::fill_block(const Camera& world_camera, const FrameLight& light,
                                const FramePlan& plan, int nearest) {
  FrameBlock b;
  std::memset(&b, 0, sizeof b);
  const Camera camera = relative_to(world_camera, scene->origin);
  put(b.view_projection,
      reversed_depth(view_projection(camera, double(target_width) / target_height)));
  put_rays(b, camera, target_width, target_height);
  put(b.eye, {to_glm(camera.eye), 0});
  put(b.background, background_of(options, features));
  const glm::dvec3 l = glm::normalize(to_glm(light.direction));
  put(b.light, {l, options.intensity});
  const bool baked = scene->baked_vertices || scene->lightmap || scene->unlit == Unlit::all;
  const double ambient = baked ? 0 : options.ambient;
  put(b.ambient, {glm::dvec3(ambient), options.exposure});
  // What textures hold needs no scale: unlit ones show it as it is, the lightmap's are scaled.
  const double scale = scene->baked_vertices ? scene->light_scale : 1;
  b.inverse[3] = float(options.baked_strength * scale);
  if (shadow) {
    const LightFit& from = shadow->fit(nearest);
    const int other = nearest == plan.to ? plan.from : plan.to;
    put(b.to_map[0], relative_to(from.to_texture, scene->origin));
    put(b.to_map[1], relative_to(shadow->fit(other).to_texture, scene->origin));
    const double between = angle_between(plan.from_direction, plan.to_direction);
    const BlendWeights w = blend_weights(blend_of(options.shadows), plan.t, between);
    // A filter of n bilinear taps per side reaches (n + 1) / 2 texels to each side. Up to that
    // distance a plane would shadow itself.
    const double reach = std::max(1.0, (options.pcf + 1) / 2.0) * from.texel;
    put(b.weights, {w.from, w.to, options.normal_offset * reach, 1.0 / options.map_resolution});
    b.eye[3] = float(rounding_of_depths(options.map_bits, camera.far_plane / from.depth_range));
    b.corner[3] = float(options.slope_bias * reach / from.depth_range);
    put_ray(b, 0, {from, nearest}, l);
    put_ray(b, 1, {shadow->fit(other), other}, l);
    b.march[2] = float(2 * from.texel / from.depth_range);
    b.march[3] = nearest == other || b.march[0] == 0 ? 1 : 2;
    b.ray_y[3] = float(1.0 / march_samples(options.march_steps, glm::degrees(between)));
    put_box(b, l, scene->bounds, scene->origin);
    put_axes(b, 0, map_axes(from.direction, options.up));
    put_axes(b, 1, map_axes(shadow->fit(other).direction, options.up));
    b.map_x[0][3] = float(pixel_size(b) * subpixel);
  }
  b.map_y[0][3] = float(options.baked_strength);
  put(b.specular, {options.specular, options.shininess, options.roughness, options.map_resolution});
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

  glBindBufferBase(GL_UNIFORM_BUFFER, 0, frame_block.get());
  glViewport(0, 0, target_width, target_height);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  if (!lighting || software) {
    float background[4];
    put(background, background_of(options, features));
    glClearNamedFramebufferfv(target.get(), GL_COLOR, 0, background);
  }
  draw_surfaces(camera, stats);
  if (lighting) draw_lighting();
  // Drivers check the current program against what is bound even where nothing is drawn, and this
  // program's maps may be deleted before another one is used.
  glUseProgram(0);
  glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
}

// Draws the surfaces, into the picture itself if nothing is lit.
void Renderer::Impl::draw_surfaces(const Camera& camera, FrameStats& stats) {
  const GLuint into = lighting ? surface_target.get() : target.get();
  glBindFramebuffer(GL_FRAMEBUFFER, into);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_GREATER);
  const float far = 0;
  glClearNamedFramebufferfv(into, GL_DEPTH, 0, &far);
  glBindVertexArray(scene->lit.get());
  draw_clusters(camera, stats);
}

// Lights each pixel's surface, and shows the background where the first pass left none. A GPU skips
// the rest of the shader there. A software renderer executes all of it for every pixel, so there
// the depth is tested, too, against a copy.
void Renderer::Impl::draw_lighting() {
  if (software) {
    glCopyImageSubData(depth.get(), GL_TEXTURE_2D, 0, 0, 0, 0, depth_copy.get(), GL_RENDERBUFFER, 0,
                       0, 0, 0, target_width, target_height, 1);
    glDepthFunc(GL_LESS);
  } else {
    glDepthFunc(GL_ALWAYS);
  }
  glDepthMask(GL_FALSE);
  glBindFramebuffer(GL_FRAMEBUFFER, target.get());
  glBindTextureUnit(0, surfaces.get());
  glBindTextureUnit(3, depth.get());
  glBindSampler(0, 0);
  glBindSampler(3, 0);
  if (shadow) shadow->bind_compare(1);
  if (features.shadow == ShadowSampling::march) shadow->bind_depths(2);
  glUseProgram(lighting.get());
  glBindVertexArray(no_vertices.get());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDepthMask(GL_TRUE);
}

// Draws the clusters front to back, without those out of view, so that hidden surfaces are not
// shaded at all. Textured scenes keep that order only within each look. Back faces are culled of
// looks that are one-sided, which come last of those of one texture.
void Renderer::Impl::draw_clusters(const Camera& camera, FrameStats& stats) {
  const Frustum frustum = frustum_of(camera, double(target_width) / target_height);
  const glm::vec3 eye(to_glm(camera.eye));
  order.clear();
  for (std::uint32_t i = 0; i < scene->clusters.size(); ++i) {
    const ViewScene::Cluster& c = scene->clusters[i];
    const glm::vec3 centre = to_glm(c.centre);
    if (!frustum.touches(centre, c.radius)) continue;
    ViewScene::Look look = c.look;
    if (!features.textured && look.cutoff <= 0)
      look = {.one_sided = c.look.one_sided, .light_page = c.look.light_page};
    if (!features.lightmap) look.light_page = -1;
    order.push_back({look, glm::length(centre - eye) - c.radius, i});
  }
  std::sort(order.begin(), order.end());
  for (std::size_t begin = 0; begin < order.size();) {
    const ViewScene::Look look = order[begin].look;
    counts.clear();
    offsets.clear();
    for (; begin < order.size() && order[begin].look == look; ++begin) {
      const ViewScene::Cluster& c = scene->clusters[order[begin].cluster];
      counts.push_back(GLsizei(c.count));
      offsets.push_back(reinterpret_cast<const void*>(std::uintptr_t(c.first) * 4));
      stats.triangles_lit += c.count / 3;
    }
    if (features.textured || look.cutoff > 0) scene->bind_texture(look);
    if (features.lightmap) scene->bind_light(look);
    glUseProgram(look.cutoff > 0 ? holed.get() : program.get());
    if (look.cutoff > 0) glUniform1f(0, look.cutoff);
    if (look.one_sided) glEnable(GL_CULL_FACE);
    glMultiDrawElements(GL_TRIANGLES, counts.data(), GL_UNSIGNED_INT, offsets.data(),
                        GLsizei(counts.size()));
    if (look.one_sided) glDisable(GL_CULL_FACE);
  }
}

}  // namespace atlas
