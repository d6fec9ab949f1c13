#include "libatlas/view/start_camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "libatlas/core/luma.h"
#include "libatlas/core/srgb.h"
#include "libatlas/exporters/viewpoint.h"
#include "libatlas/view/view_light.h"

namespace atlas {
namespace {

// Returns the luma of the nearest texel, linear. Images repeat, which does not matter to pages.
float texel_luma(const Image8& image, float u, float v) {
  const auto texel = [](float t, int n) {
    return std::min(int((t - std::floor(t)) * float(n)), n - 1);
  };
  const std::uint8_t* p = image.at(texel(u, image.width), texel(v, image.height));
  const int last = image.channels < 3 ? 0 : 2;
  return luma(srgb_decode8(p[0]), srgb_decode8(p[last / 2]), srgb_decode8(p[last]));
}

// What a cluster shows besides its vertices; null where it has none.
struct Images {
  const Image8* texture;
  const ImageF* light;
};

Images images_of(const ViewScene& scene, const ViewScene::Look& look) {
  const Image8* texture =
      look.texture < 0 ? nullptr : &scene.textures[std::size_t(look.texture)].image;
  if (texture != nullptr && texture->empty()) texture = nullptr;
  return {texture,
          look.light_page < 0 ? nullptr : &scene.lightmap->pages[std::size_t(look.light_page)]};
}

// Returns the light at a vertex, of which 1 is white. Without any there, unlit materials show their
// colours, and others are dark beside a lightmap.
Vec3f light_at(const ViewScene& scene, std::uint32_t vertex) {
  const auto scale = float(scene.light_scale);
  if (!scene.illumination.empty()) {
    const Vec3f& e = scene.illumination[vertex];
    return {scale * e.x, scale * e.y, scale * e.z};
  }
  const bool dark =
      scene.lightmap && (scene.unlit_vertices.empty() || !scene.unlit_vertices[vertex]);
  return dark ? Vec3f{} : Vec3f{1, 1, 1};
}

// Returns the mean display value of a baked scene's triangle, whose first corner is scene.indices
// [first].
std::uint8_t shown_by(const ViewScene& scene, std::size_t first, const Images& images) {
  float sum = 0;
  for (int sample = 0; sample < 3; ++sample) {
    float light = 0, on_map = 0;
    Vec2f uv{}, light_uv{};
    std::array<float, 3> weights{1 / 6.0f, 1 / 6.0f, 1 / 6.0f};
    weights[std::size_t(sample)] = 2 / 3.0f;
    const auto add = [&](Vec2f& to, const Vec2f& from, float weight) {
      to = {to.x + weight * from.x, to.y + weight * from.y};
    };
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t p = scene.indices[first + k];
      if (images.texture != nullptr) add(uv, scene.texcoords[p], weights[k]);
      if (images.light != nullptr) add(light_uv, scene.light_texcoords[p], weights[k]);
    }
    const Vec3f map = images.light == nullptr ? Vec3f{} : light_on_page(*images.light, light_uv);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t p = scene.indices[first + k];
      const Vec3f c = scene.colours[p], e = light_at(scene, p);
      light += weights[k] * luma(c.x * e.x, c.y * e.y, c.z * e.z);
      on_map += weights[k] * luma(c.x * map.x, c.y * map.y, c.z * map.z);
    }
    light += float(scene.light_scale) * on_map;
    sum += srgb_encode(images.texture == nullptr ? light
                                                 : light * texel_luma(*images.texture, uv.x, uv.y));
  }
  return quantize8(sum / 3);
}

// Returns what each triangle of a baked scene shows, as display values.
std::vector<std::uint8_t> shown_light(const ViewScene& scene, const Context& context) {
  std::vector<std::uint8_t> shown(scene.triangle_count());
  for (const ViewScene::Cluster& cluster : scene.clusters) {
    if (context.cancelled()) break;
    const Images images = images_of(scene, cluster.look);
    for (std::uint32_t i = cluster.first; i < cluster.first + cluster.count; i += 3)
      shown[i / 3] = shown_by(scene, i, images);
  }
  return shown;
}

Viewpoint start_of(const ViewScene& scene, ViewpointOptions options, const Context& context) {
  if (!scene.baked())
    return choose_viewpoint(scene.caster_positions, scene.caster_indices, options, context);
  const std::vector<std::uint8_t> light = shown_light(scene, context);
  options.light = light;
  return choose_viewpoint(scene.positions, scene.indices, options, context);
}

}  // namespace

Camera start_camera(const ViewScene& scene, const Vec3d& up, double fov_degrees,
                    const Context& context) {
  Camera camera = camera_for(scene.bounds, up, fov_degrees);
  if (scene.start) {
    const Vec3d &p = scene.start->position, &d = scene.start->direction;
    const Vec3d& o = scene.origin;
    camera.eye = {p.x - o.x, p.y - o.y, p.z - o.z};
    fit_planes(camera, scene.bounds);
    const double reach = camera.far_plane;
    camera.target = {camera.eye.x + reach * d.x, camera.eye.y + reach * d.y,
                     camera.eye.z + reach * d.z};
    return camera;
  }
  if (up.x != 0 || scene.caster_indices.empty()) return camera;
  ViewpointOptions eye;
  eye.metres_per_unit = scene.metres_per_unit;
  eye.up = up.z != 0 ? Up::z : Up::y;
  const Viewpoint start = start_of(scene, eye, context);
  if (!start.inside) return camera;
  camera.eye = start.position;
  camera.target = {start.position.x + start.direction.x, start.position.y + start.direction.y,
                   start.position.z + start.direction.z};
  fit_planes(camera, scene.bounds);
  return camera;
}

}  // namespace atlas
