#include "libatlas/view/start_camera.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "libatlas/core/luma.h"
#include "libatlas/core/srgb.h"
#include "libatlas/exporters/viewpoint.h"

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

// Returns the mean display value of a baked scene's triangle, whose first corner is scene.indices
// [first].
std::uint8_t shown_by(const ViewScene& scene, std::size_t first, const Image8* image) {
  float sum = 0;
  for (int sample = 0; sample < 3; ++sample) {
    float light = 0, u = 0, v = 0;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t p = scene.indices[first + std::size_t(k)];
      const float weight = k == sample ? 2 / 3.0f : 1 / 6.0f;
      const Vec3f c = scene.colours[p];
      const Vec3f e = scene.illumination.empty() ? Vec3f{1, 1, 1} : scene.illumination[p];
      const float scale = scene.illumination.empty() ? 1 : float(scene.light_scale);
      light += weight * scale * luma(c.x * e.x, c.y * e.y, c.z * e.z);
      if (image != nullptr) {
        u += weight * scene.texcoords[p].x;
        v += weight * scene.texcoords[p].y;
      }
    }
    sum += srgb_encode(image == nullptr ? light : light * texel_luma(*image, u, v));
  }
  return quantize8(sum / 3);
}

// Returns what each triangle of a baked scene shows, as display values.
std::vector<std::uint8_t> shown_light(const ViewScene& scene, const Context& context) {
  std::vector<std::uint8_t> shown(scene.triangle_count());
  for (const ViewScene::Cluster& cluster : scene.clusters) {
    if (context.cancelled()) break;
    const std::int32_t texture = cluster.look.texture;
    const Image8* image = texture < 0 ? nullptr : &scene.textures[std::size_t(texture)].image;
    if (image != nullptr && image->empty()) image = nullptr;
    for (std::uint32_t i = cluster.first; i < cluster.first + cluster.count; i += 3)
      shown[i / 3] = shown_by(scene, i, image);
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
    const auto [p, d] = *scene.start;
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
