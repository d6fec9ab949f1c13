// Internal: light and atlas at any point of a triangle. Include it from .cpp files only.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "benchmarks/support/staged.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas::bench {

// Returns the page's colour between its texels, as a viewer looks it up: bilinear, in [0, 1].
inline glm::dvec3 lookup(const Image8& page, Vec2d at) {
  const double x = at.x - 0.5, y = at.y - 0.5;
  const int i = int(std::floor(x)), j = int(std::floor(y));
  const double s = x - i, t = y - j;
  glm::dvec3 sum(0);
  for (int k = 0; k < 4; ++k) {
    const int px = std::clamp(i + k % 2, 0, page.width - 1);
    const int py = std::clamp(j + k / 2, 0, page.height - 1);
    const std::uint8_t* texel = page.at(px, py);
    sum += (k % 2 ? s : 1 - s) * (k / 2 ? t : 1 - t) * glm::dvec3(texel[0], texel[1], texel[2]);
  }
  return sum / 255.0;
}

// Light and atlas at any point of a triangle.
class BakedSurface {
 public:
  BakedSurface(const Staged& staged, const std::vector<Image8>& pages, std::uint32_t triangle)
      : staged_(staged),
        placement_(staged.layout->placements[staged.charts->triangle_chart[triangle]]),
        page_(pages[std::size_t(placement_.page)]),
        light_(staged.sampler->prepare(triangle, 0)) {
    const Scene& scene = staged.scene();
    for (int k = 0; k < 3; ++k) {
      corner[k] = to_dvec(scene.positions[scene.indices[3 * triangle + k]]);
      uv_[k] = to_glm(staged.charts->uvs[staged.charts->triangle_uv[3 * triangle + k]]);
    }
  }

  glm::dvec3 at(glm::dvec3 b) const { return b.x * corner[0] + b.y * corner[1] + b.z * corner[2]; }
  glm::dvec3 input(glm::dvec3 b) const {
    const Vec3f v = LuminanceSampler::sample(light_, float(b.x), float(b.y), float(b.z));
    return to_dvec(staged_.tone->display(v));
  }
  glm::dvec3 baked(glm::dvec3 b) const {
    const glm::dvec2 uv = b.x * uv_[0] + b.y * uv_[1] + b.z * uv_[2];
    return lookup(page_, page_texel(placement_, from_glm(uv)));
  }
  double texel() const {
    return 1 / std::sqrt(placement_.texels_per_unit.x * placement_.texels_per_unit.y);
  }
  double area() const {
    return 0.5 * glm::length(glm::cross(corner[1] - corner[0], corner[2] - corner[0]));
  }

  std::array<glm::dvec3, 3> corner;

 private:
  const Staged& staged_;
  const ChartPlacement& placement_;
  const Image8& page_;
  LuminanceSampler::Triangle light_;
  std::array<glm::dvec2, 3> uv_;
};

}  // namespace atlas::bench
