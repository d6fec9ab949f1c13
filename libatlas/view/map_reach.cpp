// Fits shadow maps to the scene or to the view.
#include <glm/geometric.hpp>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/view/renderer_impl.h"

namespace atlas {

// A room's own sphere is a little larger than that of the middle nine tenths of its vertices.
double Renderer::Impl::reach(const Camera& camera) const {
  if (options.view_distance > 0) return options.view_distance;
  const glm::dvec3 low = to_glm(scene->middle.low), high = to_glm(scene->middle.high);
  const double distance = glm::length(to_glm(camera.eye) - (low + high) * 0.5);
  return distance + 1.25 * glm::length(high - low) / 2;
}

Result<LightFit> Renderer::Impl::fit(const Camera& camera, const Vec3d& direction) const {
  LightFitOptions f;
  f.resolution = options.map_resolution;
  f.up = options.up;
  f.snap = options.snap;
  // Leaves room for filters, and for the march to look beside the fitted part.
  f.border_texels = options.map_resolution / 128.0;
  if (options.fit_view) {
    f.view = true;
    // A third more than is visible, so that the camera can move some way before the keys must be
    // drawn anew.
    f.view_corners =
        view_corners(camera, double(options.width) / options.height, 1.33 * reach(camera));
  }
  return fit_light(direction, scene->bounds, f);
}

bool Renderer::Impl::view_left_the_keys(const Camera& camera) const {
  if (!options.fit_view || !view_fit_valid) return false;
  const auto corners = view_corners(camera, double(options.width) / options.height, reach(camera));
  const LightFit* const fits[] = {&view_fit, &shadow->fit(sampled[0]), &shadow->fit(sampled[1])};
  for (const LightFit* fit : fits)
    for (const Vec3d& corner : corners) {
      const Vec3d m = transform_point(fit->to_texture, corner);
      if (!(m.x >= 0 && m.x <= 1 && m.y >= 0 && m.y <= 1)) return true;
    }
  return false;
}

Result<MapReach> Renderer::map_reach(const Camera& camera, const Vec3d& direction) const {
  if (!impl_->shadow) return MapReach{};
  const Result<LightFit> fit = impl_->fit(camera, direction);
  if (!fit.ok()) return fit.status();
  return MapReach{impl_->options.fit_view ? impl_->reach(camera) : 0, fit->texel};
}

}  // namespace atlas
