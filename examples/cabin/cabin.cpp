// The whole cabin: its lights, and its coarse mesh of a wanted size.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "examples/cabin/layout.h"
#include "examples/cabin/lighting.h"

namespace cabin {
namespace {

// Orders the corners clockwise as seen from the side to which `towards` points.
AreaLight make_light(std::vector<glm::vec3> corners, glm::vec3 exitance, glm::vec3 towards) {
  const glm::vec3 n = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
  const bool turned = glm::dot(n, towards) > 0;
  if (turned) std::reverse(corners.begin(), corners.end());
  return {std::move(corners), exitance, turned ? n : -n};
}

// Returns the sky in the opening of a window. The low sun is on the port side, so the sky there is
// warmer and brighter.
AreaLight window_light(int side, int bay) {
  const double height = wall_height(kWindowHeight), x = (bay + 0.5) * kBay;
  const glm::dvec3 centre = wall_point(side, x, height, -kRevealDepth);
  const double angle = height / kRadius;
  const glm::dvec3 up(0, -side * std::sin(angle), std::cos(angle));
  std::vector<glm::vec3> corners;
  for (int i = 0; i < 12; ++i) {
    const double a = (i + 0.5) * std::numbers::pi / 6;
    const glm::dvec2 p = kRevealScale * window_rim(std::cos(a), std::sin(a));
    corners.push_back(glm::vec3(centre + glm::dvec3(p.x, 0, 0) + p.y * up));
  }
  const glm::vec3 sky = side < 0 ? glm::vec3(1500, 1330, 1100) : glm::vec3(1000, 1130, 1340);
  return make_light(std::move(corners), sky, {0, -float(side), 0});
}

Builder model(double edge_length, bool coarse) {
  Builder builder(edge_length, coarse);
  add_shell(builder);
  add_ceiling(builder);
  add_bins(builder);
  add_seats(builder);
  add_door(builder);
  add_galley(builder);
  return builder;
}

}  // namespace

Lights cabin_lights() {
  std::vector<AreaLight> lights;
  const auto materials = cabin_materials();
  for (const Strip& strip : light_strips()) {
    const auto it = std::find_if(materials.begin(), materials.end(), [&](const SurfaceMaterial& m) {
      return m.name == strip.material;
    });
    const double length = (strip.x1 - strip.x0) / strip.pieces;
    const glm::dvec3 across(0, strip.to.x - strip.from.x, strip.to.y - strip.from.y);
    const glm::vec3 towards(glm::cross(glm::dvec3(1, 0, 0), across));
    for (int i = 0; i < strip.pieces; ++i) {
      const glm::dvec3 a(strip.x0 + i * length, strip.from.x, strip.from.y), along(length, 0, 0);
      lights.push_back(make_light({glm::vec3(a), glm::vec3(a + along),
                                   glm::vec3(a + along + across), glm::vec3(a + across)},
                                  it->emission, towards));
    }
  }
  for (int side : {-1, 1})
    for (int bay = 0; bay < kBays; ++bay)
      if (has_window(bay)) lights.push_back(window_light(side, bay));
  return {std::move(lights),
          {glm::normalize(glm::vec3(-0.34f, -1.0f, 0.17f)), glm::vec3(2100, 1640, 1050), 0.008f}};
}

Mesh build_cabin(std::size_t triangles, std::size_t limit, const atlas::Context& context) {
  double fine = 0.01, wide = 0.8;
  const bool coarse = model(wide, false).triangle_count() > limit;
  // The count falls in steps as the edge length rises. Bisects for the finest mesh that has not too
  // many triangles.
  for (int i = 0; i < 10; ++i) {
    if (context.cancelled()) return {};
    const double middle = std::sqrt(fine * wide);
    (model(middle, coarse).triangle_count() <= triangles ? wide : fine) = middle;
  }
  return model(wide, coarse).finish(cabin_materials());
}

}  // namespace cabin
